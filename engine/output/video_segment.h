#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core.hpp>

#include "engine/output/libav.h"
#include "engine/output/video.h"

namespace planecast::engine {

/// One closed segment: its own encoder, its own file.
class VideoWriter::Segment {
 public:
  Segment(const std::filesystem::path& path, cv::Size size, FrameRate rate,
          const VideoOptions& options);

  void write(const cv::Mat& bgr);
  /// Flushes the encoder and gives the file its final name.
  void finish();

 private:
  void open_encoder(const VideoOptions& options);
  void open_scaler();
  void drain();

  std::filesystem::path path_;
  cv::Size size_;       ///< of the frames
  cv::Size even_size_;  ///< of the video
  FrameRate rate_;
  libav::Mp4Muxer muxer_;
  libav::CodecContext encoder_;
  libav::Scaler scaler_;
  libav::Frame frame_;
  libav::Packet packet_;
  std::int64_t next_frame_ = 0;
};

}  // namespace planecast::engine
