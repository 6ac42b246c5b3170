#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "engine/sequence/camera_file.h"
#include "engine/sequence/sequence.h"

namespace planecast::engine {

/// What every kind of input decides in the same way once its first image is known.
struct FrameSetup {
  cv::Size input_size;      ///< of the recorded images
  cv::Size output_size;     ///< of the frames handed out
  CameraSettings settings;  ///< the camera is that of the output size
};

/// The user's camera, else `found_camera_file`, else a guess with a warning; scaled to the frames.
/// `path` names the input in messages.
FrameSetup set_up_frames(const std::filesystem::path& path, const SequenceOptions& options,
                         const std::filesystem::path& found_camera_file, cv::Size image_size,
                         std::vector<std::string>& warnings);

/// The wanted part [first, end) of `total` frames. Throws UserError when it is empty.
struct FrameRange {
  int first = 0;
  int end = 0;
};
FrameRange select_frames(const SequenceOptions& options, int total,
                         const std::filesystem::path& path);

/// Area-averaged when it shrinks, else bilinear; depth and labels keep their values.
cv::Mat resize_image(const cv::Mat& image, cv::Size size);
cv::Mat resize_nearest(const cv::Mat& values, cv::Size size);

}  // namespace planecast::engine
