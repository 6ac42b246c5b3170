#pragma once

#include "slam/data/map.h"
#include "slam/stages/plane_points.h"
#include "slam/stages/stereo_depth.h"

namespace planecast::slam {

struct PlaneByPatchesOptions {
  int samples = 300;  ///< of the plane's depth points
  int fewest = 12;    ///< points that must be found; the plane's landmarks count as well
  int octave = 2;     ///< of a patch, in `levels`
  double min_correlation = 0.7;
  double max_residual_px = 1.0;  ///< of a point's sights
  ScaleLevels levels = {4, 1.5};
  StereoDepthOptions beside;  ///< which keyframes are asked
};

/// [D] A plane that was found in the depth of pairs of keyframes, fitted to what is ten times as
/// precise: its depth points are found as patches, warped by the plane, in the keyframes beside
/// their own, and placed by all of them. Returns whether enough were found; if so, the plane is
/// now the likeliest sheet (plane_mixture.h) in them and its landmarks.
bool refit_by_patches(const Map& map, Plane& plane, const PlaneSupport& support,
                      const PlaneContext& context, const PlaneByPatchesOptions& options);

}  // namespace planecast::slam
