#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "engine/pipeline/reconstruction.h"
#include "engine/sequence/sequence.h"

namespace planecast::engine {

/// What is known of a sequence beyond its images.
struct SequenceTruth {
  slam::Camera camera;
  std::vector<TimedPose> poses;              ///< within the time of the chosen frames
  std::vector<PlaneRecord> planes;           ///< of planes.json (a synthetic sequence), else empty
  std::optional<std::set<int>> seen_labels;  ///< of the masks in the chosen frames (visibility.h)
};

/// Reads the true poses of a sequence's folder (or of `groundtruth` where that is given) and its
/// planes where it has them. Throws UserError where there are no true poses.
SequenceTruth read_sequence_truth(const std::filesystem::path& sequence,
                                  const SequenceOptions& options,
                                  const std::filesystem::path& groundtruth = {});

}  // namespace planecast::engine
