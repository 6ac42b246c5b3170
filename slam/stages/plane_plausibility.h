#pragma once

#include <vector>

#include "slam/geometry/plane_geometry.h"
#include "slam/stages/plane_points.h"

namespace planecast::slam {

/// What a fit must show beyond count and RMS to be a plane and not a slab cut out of clutter [D]. A
/// slab of scattered points has as many points beside it as in it, its points' neighbours in the
/// image are others', and many such slabs run along the viewing rays.
struct PlausibilityOptions {
  double min_contrast = 3.0;   ///< density inside the band over that between 1 and 3 bands
  double min_coherence = 0.5;  ///< share of the inliers' nearest image neighbours that are inliers
  int min_coherent_neighbours = 2;  ///< of kCoherenceNeighbours; an inlier with fewer is dropped
  double min_view_cosine = 0.1;     ///< mean, of viewing rays to the normal
  double min_breadth = 1.5;  ///< standard deviation along the shorter side, in the candidate's eps
  double min_slimness = 0.07;  ///< of the shorter side over the longer
};
inline constexpr int kCoherenceNeighbours = 6;

/// A plane and the points of a keyframe that are taken to lie on it.
struct PlaneCandidate {
  PlaneEquation plane;
  std::vector<int> inliers;  ///< indices into KeyframePoints
  double eps = 0.0;          ///< its own inlier distance (own_eps)
};

/// Number of the nearest image neighbours of point i that are marked; needs shown.nearest.
int marked_neighbours(const KeyframePoints& shown, const std::vector<char>& marks, int i);

/// Share of the inliers' nearest image neighbours that are inliers; needs shown.nearest.
double coherence(const KeyframePoints& shown, const PlaneCandidate& candidate);

/// Drops inliers that lie amid others in the image; needs shown.nearest.
void keep_coherent(const KeyframePoints& shown, const PlausibilityOptions& options,
                   PlaneCandidate& candidate);

/// Keeps the largest patch: what lies across a gap may be another plane of the same height.
void keep_connected(const KeyframePoints& shown, const PlaneScale& scale,
                    PlaneCandidate& candidate);

/// Neither a line of points nor seen edge-on.
bool is_broad(const KeyframePoints& shown, const PlaneCandidate& candidate,
              const PlausibilityOptions& options);

/// Density of points in the band over that beside it, over the same patch; infinite where nothing
/// is beside. Beside it count the points that no plane owns or one that is nearly parallel, so that
/// no second layer is laid over a noisy plane; of an image with masks those of the same instance
/// alone, which are what the mask claims to be on the plane.
double contrast(const Map& map, const KeyframePoints& shown, const PlaneCandidate& candidate,
                const PlaneScale& scale);

}  // namespace planecast::slam
