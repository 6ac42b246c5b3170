#pragma once

#include "slam/data/camera.h"
#include "slam/data/map.h"
#include "slam/stages/match_patches.h"

namespace planecast::slam {

struct RefineSightsResult {
  int refined = 0;
  int removed = 0;  ///< look like no other sight
};

/// Makes the sights of each landmark mean one spot of the surface. While the map grows, a landmark
/// is found in a new keyframe by its looks in the nearest one, or by a corner that was detected
/// there: the small errors add up from keyframe to keyframe. Here every sight is aligned anew with
/// one reference, the sight of the keyframe nearest to the middle of those that see the landmark,
/// and its keypoint is moved there. What does not look like that, as from far to one side, is
/// aligned with the nearest sight that does. What looks like neither is removed, and with the last
/// but one sight the landmark: corners that are not what they were taken for are wrong alike in
/// many keyframes, which no loss tells from a drift of the map. Before a global bundle adjustment;
/// poses and positions must be nearly right and are not changed. Depth, octave and descriptor of a
/// keypoint stay. Keyframes without an image pyramid are passed over.
RefineSightsResult refine_sights(Map& map, const Camera& camera, const PatchMatchOptions& options);

}  // namespace planecast::slam
