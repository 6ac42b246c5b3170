#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "engine/sequence/synth/room_model.h"
#include "slam/data/types.h"

namespace planecast::engine::synth {

/// Where and how often a plane was seen.
struct PlaneSighting {
  long long pixels = 0;
  int first_frame = -1;
};

/// Collects what is written once: the lists, the trajectory and the planes.
class TruthFiles {
 public:
  TruthFiles(std::filesystem::path folder, const std::vector<TruePlane>& planes);

  /// `stamp` is the time as printed, also the name of the frame's files.
  void add_frame(const std::string& stamp, int frame, const slam::Pose& world_from_cam,
                 const cv::Mat& mask);
  void write() const;

 private:
  std::filesystem::path folder_;
  const std::vector<TruePlane>& planes_;
  std::vector<PlaneSighting> sightings_;  ///< by label - 1
  std::string rgb_, depth_, mask_, trajectory_;
};

}  // namespace planecast::engine::synth
