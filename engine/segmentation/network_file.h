#pragma once

#include <filesystem>
#include <memory>

#include "slam/segmentation/network.h"

namespace planecast::engine {

/// Reads the description beside an ONNX file: the same name with .yaml (docs/segmentation.md).
/// Throws UserError.
slam::NetworkDescription read_network_description(const std::filesystem::path& file);

/// Reads an ONNX file with its description. Throws UserError naming the file: missing, no ONNX, or
/// not what the description says.
std::unique_ptr<slam::PlaneSegmenter> read_network(const std::filesystem::path& onnx);

}  // namespace planecast::engine
