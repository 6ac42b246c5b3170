#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "engine/sequence/camera_file.h"
#include "engine/sequence/sequence.h"

namespace planecast::engine {

/// One frame on disk. Depth and mask are empty where there is none.
struct FrameFiles {
  double timestamp = 0.0;
  std::filesystem::path image;
  std::filesystem::path depth;
  std::filesystem::path mask;
};

/// What is recorded in a folder, whatever its layout.
struct ImageList {
  std::filesystem::path path;
  std::vector<FrameFiles> frames;
  bool has_timestamps = true;  ///< false: they number the frames; the frame rate makes them times
  std::filesystem::path camera_file;  ///< found in the folder, or the preset of its layout
  std::vector<std::string> warnings;
};

/// Folders with rgb.txt (TUM), associations.txt (ICL-NUIM), mav0/cam0 (EuRoC),
/// frame-NUMBER.color.png (7-Scenes), or just images in the natural order of their names; also a
/// single image. Throws UserError.
ImageList list_images(const std::filesystem::path& path);

/// Opens the files behind a list.
std::unique_ptr<Sequence> open_image_list(ImageList list, const SequenceOptions& options);

/// Whether a < b with runs of digits compared as numbers: frame2 before frame10.
bool natural_less(const std::string& a, const std::string& b);

}  // namespace planecast::engine
