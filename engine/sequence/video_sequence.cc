#include "engine/sequence/video_sequence.h"

#include <fmt/format.h>

#include <cmath>
#include <opencv2/videoio.hpp>
#include <utility>

#include "engine/cancel.h"
#include "engine/sequence/frame_setup.h"
#include "engine/sequence/image_file.h"
#include "engine/user_error.h"

namespace planecast::engine {

namespace fs = std::filesystem;

namespace {

// Outside of it the container's figure is a time base or nonsense, not a frame rate.
constexpr double kMinFps = 0.1;
constexpr double kMaxFps = 1000.0;
constexpr double kDefaultFps = 30.0;

cv::VideoCapture open_capture(const fs::path& path) {
  // Absolute, so that FFmpeg never takes "a:b.mp4" for a protocol.
  // A pipe or a device may keep its reader waiting for ever, and cannot be read twice.
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) throw UserError(path.string() + ": not a file");
  cv::VideoCapture capture;
  try {
    capture.open(fs::absolute(path).string(), cv::CAP_FFMPEG);
  } catch (const cv::Exception&) {
    capture.release();
  }
  if (!capture.isOpened()) throw UserError(path.string() + ": not a video that FFmpeg can read");
  check_image_size(path, static_cast<int>(capture.get(cv::CAP_PROP_FRAME_WIDTH)),
                   static_cast<int>(capture.get(cv::CAP_PROP_FRAME_HEIGHT)));
  return capture;
}

struct VideoFacts {
  int frames = 0;  ///< decodable, counted up to the wanted end
  cv::Size size;
  double fps = kDefaultFps;
  std::vector<std::string> warnings;
};

VideoFacts survey(const fs::path& path, int stop_after) {
  cv::VideoCapture capture = open_capture(path);
  VideoFacts facts;
  const double fps = capture.get(cv::CAP_PROP_FPS);
  if (fps >= kMinFps && fps <= kMaxFps) facts.fps = fps;
  const double promised = capture.get(cv::CAP_PROP_FRAME_COUNT);
  cv::Mat first;
  if (!capture.read(first) || first.empty()) {
    throw UserError(path.string() + ": no frame of the video can be decoded");
  }
  facts.size = first.size();
  facts.frames = 1;
  while ((stop_after < 0 || facts.frames < stop_after) && capture.grab()) {
    throw_if_cancelled();
    ++facts.frames;
  }
  const bool to_the_end = stop_after < 0 || facts.frames < stop_after;
  // Containers are often wrong by a frame or two.
  if (to_the_end && promised < 1e9 && facts.frames < 0.98 * promised - 2) {
    facts.warnings.push_back(fmt::format("{}: only {} of {:.0f} frames can be decoded",
                                         path.string(), facts.frames, promised));
  }
  return facts;
}

class VideoSequence : public Sequence {
 public:
  VideoSequence(fs::path path, VideoFacts facts, const SequenceOptions& options)
      : path_(std::move(path)),
        facts_(std::move(facts)),
        range_(select_frames(options, facts_.frames, path_)),
        setup_(set_up_frames(path_, options, {}, facts_.size, facts_.warnings)) {}

  int first_frame() const override { return range_.first; }
  int end_frame() const override { return range_.end; }
  double timestamp(int index) const override { return std::round(index / facts_.fps * 1e6) / 1e6; }
  bool has_depth() const override { return false; }
  bool has_labels() const override { return false; }
  const slam::Camera& camera() const override { return setup_.settings.camera; }
  double fps() const override { return facts_.fps; }
  std::string name() const override { return path_.stem().string(); }
  fs::path path() const override { return path_; }
  const std::vector<std::string>& warnings() const override { return facts_.warnings; }

  slam::FrameInput read(int index) override {
    slam::FrameInput frame;
    frame.index = index;
    frame.timestamp = timestamp(index);
    frame.image = resize_image(decode(index), setup_.output_size).clone();
    return frame;
  }

 private:
  /// Decodes forward to `index`; begins again only to go back, since seeking is not exact in
  /// every container.
  const cv::Mat& decode(int index) {
    if (index == current_index_) return current_;
    if (index < current_index_ || !capture_.isOpened()) {
      capture_ = open_capture(path_);
      current_index_ = -1;
    }
    while (current_index_ + 1 < index) {
      if (!capture_.grab()) fail_at(current_index_ + 1);
      ++current_index_;
    }
    if (!capture_.read(current_) || current_.empty()) fail_at(index);
    if (current_.size() != facts_.size) {
      throw UserError(fmt::format("{}: frame {} is {}x{} pixels, but the video began with {}x{}",
                                  path_.string(), index, current_.cols, current_.rows,
                                  facts_.size.width, facts_.size.height));
    }
    current_index_ = index;
    return current_;
  }

  [[noreturn]] void fail_at(int index) {
    capture_.release();
    current_index_ = -1;
    throw UserError(fmt::format("{}: frame {} cannot be decoded", path_.string(), index));
  }

  fs::path path_;
  VideoFacts facts_;
  FrameRange range_;
  FrameSetup setup_;
  cv::VideoCapture capture_;
  cv::Mat current_;
  int current_index_ = -1;  ///< the frame last taken from the decoder
};

}  // namespace

std::unique_ptr<Sequence> open_video(const fs::path& path, const SequenceOptions& options) {
  return std::make_unique<VideoSequence>(path, survey(path, options.end_frame), options);
}

}  // namespace planecast::engine
