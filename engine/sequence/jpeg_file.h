#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace planecast::engine {

/// Decodes a common JPEG picture (8 bits, YCbCr, not turned by EXIF) to CV_8UC3 BGR: the bytes that
/// cv::imdecode gives, without the pass over the pixels that swaps their channels there. Empty for
/// anything else and for what does not decode without a warning: leave that to cv::imdecode.
cv::Mat decode_common_jpeg(const std::vector<std::uint8_t>& bytes);

}  // namespace planecast::engine
