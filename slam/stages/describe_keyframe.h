#pragma once

#include <vector>

#include "slam/data/camera.h"
#include "slam/data/map.h"
#include "slam/stages/localise.h"
#include "slam/stages/match_patches.h"
#include "slam/stages/prepare_image.h"

namespace planecast::slam {

struct DescribeKeyframeOptions {
  int keypoints = 1000;   ///< corners and landmarks together, as of an image with ORB alone [K]
  int min_corners = 400;  ///< however many landmarks there are: new ones start from corners
  double snap_px =
      2.0;  ///< a corner so near to a landmark's patch, at its level, is that landmark's
  LocaliseOptions localise;
  PatchMatchOptions patches;  ///< beyond those of the tracker
  DescribeKeyframeOptions() { patches.max_matches = 150; }
};

/// Gives corners to an image that was tracked by patches and is to become a keyframe. Landmarks
/// found by their looks keep the precise positions: the corner there is moved to it, or one is
/// added. The tracker stops when it has found enough; here the other landmarks about are looked for
/// as well. `estimate`: of the tracker, in `map`. Returns the estimate over the features, which
/// have no descriptors yet (OrbExtractor::describe()).
PoseEstimate describe_keyframe(const Map& map, const Camera& camera, const PoseEstimate& estimate,
                               const DescribeKeyframeOptions& options, ImagePreparer& preparer,
                               ImageFeatures& image);

}  // namespace planecast::slam
