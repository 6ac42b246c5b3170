#pragma once

#include "slam/data/camera.h"
#include "slam/data/map.h"
#include "slam/stages/match_patches.h"

namespace planecast::slam {

struct RefineSightsResult {
  int refined = 0;
  int kept = 0;  ///< could not be aligned and stay where they were
};

/// Makes the sights of each landmark mean one spot of the surface. While the map grows, a landmark
/// is found in a new keyframe by its looks in the nearest one, or by a corner that was detected
/// there: the small errors add up from keyframe to keyframe. Here every sight is aligned anew with
/// one reference, the sight of the keyframe nearest to the middle of those that see the landmark,
/// and its keypoint is moved there. Before a global bundle adjustment, which tells what went wrong;
/// poses and positions must be nearly right and are not changed. Depth, octave and descriptor of a
/// keypoint stay. Keyframes without an image pyramid are passed over.
RefineSightsResult refine_sights(Map& map, const Camera& camera, const PatchMatchOptions& options);

}  // namespace planecast::slam
