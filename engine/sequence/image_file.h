#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core.hpp>

namespace planecast::engine {

/// Longest side and most pixels that are decoded (four 8K pictures); the header is read first, so
/// that a forged one costs no memory.
inline constexpr int kMaxImageSide = 16384;
inline constexpr long long kMaxImagePixels = 1LL << 27;
/// Longest file of a picture.
inline constexpr std::uintmax_t kMaxImageBytes = std::uintmax_t{1} << 30;
/// Throws UserError naming the file where the size is beyond these.
void check_image_size(const std::filesystem::path& file, int width, int height);

/// Whether the name ends in a still image's suffix: png jpg jpeg bmp tif tiff, any case.
bool has_image_suffix(const std::filesystem::path& file);

/// Each reads PNG, JPEG, BMP and TIFF, and throws UserError naming the file when it is none of
/// them, missing, truncated, damaged or too large. 8-bit BGR.
cv::Mat read_color_image(const std::filesystem::path& file);
/// 16-bit depth image -> CV_32F metres; 0 and 65535 mean no measurement and become 0.
cv::Mat read_depth_image(const std::filesystem::path& file, double depth_factor);
/// 8- or 16-bit labels as they are, or 24-bit colour = instance -> CV_16U; see labels.h.
cv::Mat read_label_image(const std::filesystem::path& file);

/// OpenCV's and FFmpeg's own messages do not reach the user; ours name the file instead.
void silence_codecs();

}  // namespace planecast::engine
