#include "engine/segmentation/choose_segmenter.h"

#include <algorithm>

#include "engine/assets.h"
#include "engine/segmentation/network_file.h"
#include "engine/user_error.h"

namespace planecast::engine {

const std::vector<std::string>& segmentation_kinds() {
  static const std::vector<std::string> kinds = {"auto", "network", "masks", "depth", "none"};
  return kinds;
}

std::string choose_kind(const SegmentationChoice& choice, bool has_masks, bool use_depth) {
  if (choice.kind != "auto") return choice.kind;
  if (!choice.network.empty()) return "network";
  return has_masks ? "masks" : use_depth ? "depth" : "none";
}

std::unique_ptr<slam::PlaneSegmenter> choose_segmenter(const SegmentationChoice& choice,
                                                       const Sequence& sequence, bool use_depth) {
  const std::string kind = choose_kind(choice, sequence.has_labels(), use_depth);
  const auto& kinds = segmentation_kinds();
  if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) {
    throw UserError("--segmentation " + kind + ": expected auto, network, masks, depth or none");
  }
  if (kind != "network" && !choice.network.empty()) {
    throw UserError("--network " + choice.network.string() + ": goes with --segmentation network");
  }
  if (kind == "masks") {
    if (!sequence.has_labels()) {
      throw UserError(sequence.path().string() + ": --segmentation masks needs mask.txt");
    }
    return slam::make_mask_segmenter();
  }
  if (kind == "depth") {
    if (!use_depth) {
      throw UserError(sequence.path().string() + ": --segmentation depth needs " +
                      (sequence.has_depth() ? "--mode rgbd" : "depth, and there is none"));
    }
    return slam::make_depth_segmenter(sequence.camera());
  }
  if (kind == "network") {
    return choose_network(choice.network);
  }
  return slam::make_no_segmenter();
}

std::unique_ptr<slam::PlaneSegmenter> choose_network(const std::filesystem::path& onnx) {
  return read_network(onnx.empty() ? asset("network/planes.onnx") : onnx);
}

}  // namespace planecast::engine
