#pragma once

#include <string>
#include <vector>

#include "render/image.h"

namespace planecast::render {

struct DecodedImage {
  ImageU8 image;      ///< 1 to 4 channels; empty on failure
  std::string error;  ///< why there is none
};

/// PNG, JPEG or WebP by their first bytes. The size is read and checked before anything is
/// decoded: at most 16384 pixels a side and 2^27 in all. Of 16-bit samples the high byte stays.
DecodedImage decode_image(const std::vector<unsigned char>& bytes);

}  // namespace planecast::render
