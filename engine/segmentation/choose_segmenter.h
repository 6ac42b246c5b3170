#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "engine/sequence/sequence.h"
#include "slam/segmentation/plane_segmenter.h"

namespace planecast::engine {

struct SegmentationChoice {
  std::string kind = "auto";      ///< one of segmentation_kinds()
  std::filesystem::path network;  ///< ONNX file; empty: our own
};

const std::vector<std::string>& segmentation_kinds();  ///< auto, network, masks, depth, none

/// What `auto` means: masks that came with the sequence, else its depth where that is used, else
/// none: our own network has to be asked for, as it is not yet as good as that.
std::string choose_kind(const SegmentationChoice& choice, bool has_masks, bool use_depth);

/// Throws UserError where the sequence has not what the choice needs, or the network is no good.
std::unique_ptr<slam::PlaneSegmenter> choose_segmenter(const SegmentationChoice& choice,
                                                       const Sequence& sequence, bool use_depth);

/// The network of a file, or our own where that is empty. Throws UserError.
std::unique_ptr<slam::PlaneSegmenter> choose_network(const std::filesystem::path& onnx);

}  // namespace planecast::engine
