#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>

namespace planecast::engine {

/// Writes an 8- or 16-bit image of 1, 3 (BGR) or 4 (BGRA) channels as PNG, atomically. The
/// compression level is fast rather than small: frames are many. Throws UserError.
void write_png(const cv::Mat& image, const std::filesystem::path& path, int compression = 3);

/// "data:image/png;base64,..." of an 8-bit image, lossless.
std::string png_data_uri(const cv::Mat& image);

/// "data:image/jpeg;base64,..." of an 8-bit image, for self-contained HTML.
std::string jpeg_data_uri(const cv::Mat& image, int quality = 85);

}  // namespace planecast::engine
