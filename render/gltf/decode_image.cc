#include "render/gltf/decode_image.h"

#include <stb/stb_image.h>
#include <webp/decode.h>

#include <cstring>
#include <memory>

namespace planecast::render {
namespace {

constexpr int kLargestSide = 16384;
constexpr long long kMostPixels = 1LL << 27;

std::string size_error(int width, int height) {
  if (width > 0 && height > 0 && width <= kLargestSide && height <= kLargestSide &&
      static_cast<long long>(width) * height <= kMostPixels) {
    return "";
  }
  return "has the size " + std::to_string(width) + "x" + std::to_string(height);
}

bool is_webp(const std::vector<unsigned char>& bytes) {
  return bytes.size() > 12 && std::memcmp(bytes.data(), "RIFF", 4) == 0 &&
         std::memcmp(bytes.data() + 8, "WEBP", 4) == 0;
}

DecodedImage decode_webp(const std::vector<unsigned char>& bytes) {
  DecodedImage result;
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(bytes.data(), bytes.size(), &features) != VP8_STATUS_OK) {
    result.error = "cannot be decoded";
    return result;
  }
  result.error = size_error(features.width, features.height);
  if (!result.error.empty()) return result;
  const int channels = features.has_alpha != 0 ? 4 : 3;
  ImageU8 image(features.width, features.height, channels);
  const int stride = features.width * channels;
  const auto* decoded = channels == 4
                            ? WebPDecodeRGBAInto(bytes.data(), bytes.size(), image.pixels.data(),
                                                 image.pixels.size(), stride)
                            : WebPDecodeRGBInto(bytes.data(), bytes.size(), image.pixels.data(),
                                                image.pixels.size(), stride);
  if (decoded == nullptr) {
    result.error = "cannot be decoded";
  } else {
    result.image = std::move(image);
  }
  return result;
}

}  // namespace

DecodedImage decode_image(const std::vector<unsigned char>& bytes) {
  if (is_webp(bytes)) return decode_webp(bytes);
  DecodedImage result;
  int width = 0;
  int height = 0;
  int channels = 0;
  const int size = static_cast<int>(bytes.size());
  if (stbi_info_from_memory(bytes.data(), size, &width, &height, &channels) == 0) {
    result.error = "cannot be decoded";
    return result;
  }
  result.error = size_error(width, height);
  if (!result.error.empty()) return result;
  // Loading 16-bit files as 8 bits keeps the high byte, which is what an 8-bit texture can hold.
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(bytes.data(), size, &width, &height, &channels, 0), &stbi_image_free);
  if (pixels == nullptr || channels < 1 || channels > 4) {
    result.error = "cannot be decoded";
    return result;
  }
  result.image = ImageU8(width, height, channels);
  std::memcpy(result.image.pixels.data(), pixels.get(), result.image.pixels.size());
  return result;
}

}  // namespace planecast::render
