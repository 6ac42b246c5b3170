#pragma once

#include <filesystem>
#include <opencv2/core.hpp>

namespace planecast::engine {

/// Longest side that is decoded; the header is read first, so that a forged one costs no memory.
inline constexpr int kMaxImageSide = 16384;

/// Whether the name ends in a still image's suffix: png jpg jpeg bmp tif tiff, any case.
bool has_image_suffix(const std::filesystem::path& file);

/// Each throws UserError naming the file when it is missing, truncated, damaged or too large.
/// 8-bit BGR.
cv::Mat read_color_image(const std::filesystem::path& file);
/// 16-bit depth image -> CV_32F metres; 0 and 65535 mean no measurement and become 0.
cv::Mat read_depth_image(const std::filesystem::path& file, double depth_factor);
/// 8- or 16-bit labels as they are, or 24-bit colour = instance -> CV_16U; see labels.h.
cv::Mat read_label_image(const std::filesystem::path& file);

/// OpenCV's and FFmpeg's own messages do not reach the user; ours name the file instead.
void silence_codecs();

}  // namespace planecast::engine
