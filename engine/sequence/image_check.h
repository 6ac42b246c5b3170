#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace planecast::engine {

/// What an image file's own structure says, without decoding its pixels.
struct ImageCheck {
  bool known = false;  ///< PNG, JPEG, BMP or TIFF
  int width = 0;       ///< 0 where the header could not be read
  int height = 0;
  std::string damage;  ///< empty: complete; else the reason, such as "the file is cut off"
};

/// Walks a PNG's chunks with their CRC (to IEND), a JPEG's markers (to EOI), a BMP's sizes or the
/// largest of a TIFF's directories. The
/// decoders behind OpenCV return a partly grey picture for a truncated file and print to stderr;
/// what passes here makes them do neither.
ImageCheck check_image_file(const std::vector<std::uint8_t>& bytes);

}  // namespace planecast::engine
