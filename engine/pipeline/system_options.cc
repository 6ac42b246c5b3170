#include "engine/pipeline/system_options.h"

#include <filesystem>
#include <fstream>
#include <optional>
#include <utility>

#include "engine/assets.h"
#include "engine/segmentation/choose_segmenter.h"
#include "engine/user_error.h"
#include "slam/segmentation/leaky_masks.h"

namespace planecast::engine {
namespace {

std::shared_ptr<const slam::Vocabulary> load_vocabulary() {
  const std::filesystem::path path = asset("vocabulary/orb.bin");
  std::ifstream in(path, std::ios::binary);
  std::optional<slam::Vocabulary> vocabulary = slam::Vocabulary::read(in);
  if (!vocabulary) throw UserError(path.string() + ": is broken or no vocabulary");
  return std::make_shared<const slam::Vocabulary>(*std::move(vocabulary));
}

}  // namespace

bool use_depth(const Sequence& sequence, const TrackSequenceOptions& options) {
  const std::string& mode = options.mode;
  if (mode == "auto") return sequence.has_depth();
  if (mode == "mono") return false;
  if (mode != "rgbd") throw UserError("--mode " + mode + ": expected mono, rgbd or auto");
  if (!sequence.has_depth()) {
    throw UserError(sequence.path().string() + ": --mode rgbd needs depth, and there is none");
  }
  return true;
}

slam::SystemOptions system_options(const TrackSequenceOptions& options, bool rgbd) {
  slam::SystemOptions result;
  result.rgbd = rgbd;
  result.seed = options.seed;
  result.orb.features = options.features;
  result.threads = options.threads;
  result.close_loops = options.close_loops;
  result.vocabulary = load_vocabulary();
  if (options.plane_merge == "paper") {
    result.mapping.planes.merge = slam::PlaneMerge::kPaper;
  } else if (options.plane_merge != "default") {
    throw UserError("--plane-merge " + options.plane_merge + ": expected default or paper");
  }
  if (options.plane_fit != "graph-cut" && options.plane_fit != "plain") {
    throw UserError("--plane-fit " + options.plane_fit + ": expected graph-cut or plain");
  }
  result.mapping.planes.graph_cut = options.plane_fit == "graph-cut";
  result.mapping.map_planes = options.map_planes;
  result.refine_jointly = options.refine_jointly;
  return result;
}

std::unique_ptr<slam::PlaneSegmenter> make_segmenter(const Sequence& sequence, bool rgbd,
                                                     const TrackSequenceOptions& options) {
  auto segmenter = choose_segmenter({options.segmentation, options.network}, sequence, rgbd);
  if (!(options.mask_leakage > 0.0)) return segmenter;
  return slam::make_leaky_segmenter(std::move(segmenter), options.mask_leakage, options.seed);
}

}  // namespace planecast::engine
