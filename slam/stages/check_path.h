#pragma once

#include <cstddef>
#include <vector>

#include "slam/data/types.h"

namespace planecast::slam {

struct CheckPathOptions {
  int window = 45;  ///< frames to either side from which the camera's usual unrest is told
  /// A pose contradicts its neighbours when it is so many times as far from where they put it as
  /// is usual there. Handheld shaking stays below 5.
  double max_ratio = 10.0;
  int max_run = 4;      ///< neighbouring frames that may be doubted together
  int min_frames = 12;  ///< shorter paths are not checked
};

/// Frame `i` of a path of consecutive frames as its neighbours put it: a cubic through the two
/// nearest trusted frames on either side. Precondition: there are two on either side.
Pose pose_between(const std::vector<Pose>& path, const std::vector<char>& trusted, std::size_t i);

/// Finds poses that contradict their neighbours: a frame that was matched to the wrong one of
/// several places that look alike jumps away and back, however well its matches agree with each
/// other. `support` is the number of matches behind each pose: of several that contradict each
/// other the weaker is doubted. Returns 1 for each pose to be trusted, 0 for each in doubt.
std::vector<char> check_path(const std::vector<Pose>& path, const std::vector<int>& support,
                             const CheckPathOptions& options = {});

}  // namespace planecast::slam
