#pragma once

#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>
#include <string>

namespace planecast::engine {

struct VideoOptions {
  /// x264's constant rate factor and preset: visually lossless, as close to the pictures as
  /// `veryfast` at 18 (42.1 dB on a real room) in little more than half of its time, a fifth
  /// larger.
  int crf = 20;
  std::string preset = "superfast";
  int segment_frames = 60;  ///< frames of an independent segment
  bool resume = false;      ///< keep the complete segments of an earlier, killed run
  /// What the pictures depend on beside these options (scene, range, ...): segments of an earlier
  /// run with another key are not resumed.
  std::string content_key;
};

/// Frames per second as the exact ratio the file gets: NTSC rates as n*1000/1001, others to 1/1000.
struct FrameRate {
  int numerator = 30;
  int denominator = 1;
};
FrameRate exact_frame_rate(double fps);

/// H.264 MP4 by libav and x264, the same bytes for the same frames on every processor (one encoder
/// thread whatever the program uses, cpu-independent, bitexact, no creation time).
///
/// Frames are encoded in closed segments, each by a fresh encoder, in `segments/NNNNNN.mp4` beside
/// the video, renamed when complete, so a killed run leaves playable segments; finish() joins them
/// by stream copy and removes the folder. yuv420p, limited range, BT.709 from 720 lines on, else
/// BT.601, tagged. Odd sizes are padded to even ones by repeating the last column or row. All
/// failures are UserError with one line naming the file.
class VideoWriter {
 public:
  VideoWriter(const std::filesystem::path& path, int width, int height, double fps,
              const VideoOptions& options = {});
  /// Without finish(): the open segment is dropped, the complete ones stay.
  ~VideoWriter();
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  /// Index of the first segment to be written: 0 but for a resumed run.
  int first_missing_segment() const { return first_missing_segment_; }
  /// Number of the first frame that write() expects. Where the earlier run had completed a shorter
  /// last segment this lies beyond the last frame, and nothing is to be written.
  int first_missing_frame() const { return first_missing_segment_ * options_.segment_frames; }

  /// CV_8UC3 BGR of the given size; any other is a std::invalid_argument.
  void write(const cv::Mat& bgr);
  /// Completes the last segment, joins, removes the segments. A video without frames is an error.
  void finish();

 private:
  class Segment;

  void prepare_folder();
  std::filesystem::path segment_path(int index) const;
  void close_segment();

  std::filesystem::path path_;
  std::filesystem::path folder_;
  cv::Size size_;
  FrameRate rate_;
  VideoOptions options_;
  int first_missing_segment_ = 0;
  int next_segment_ = 0;
  int frames_in_segment_ = 0;
  std::unique_ptr<Segment> segment_;
};

}  // namespace planecast::engine
