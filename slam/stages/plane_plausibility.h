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
  double min_own_coherence = 0.3;  ///< an inlier of which fewer neighbours are inliers is dropped
  double min_view_cosine = 0.1;    ///< mean, of viewing rays to the normal
  double min_breadth = 1.5;  ///< standard deviation along the shorter side, in the candidate's eps
  double min_breadth_in_mask = 1.0;  ///< the same where a mask speaks for the plane
  double min_facing = 0.6;           ///< see is_faced()
  double min_facing_of_thick = 0.5;  ///< ... those that do over the inliers
  double min_slimness = 0.07;        ///< of the shorter side over the longer
};
inline constexpr int kCoherenceNeighbours = 6;

/// A plane and the points of a keyframe that are taken to lie on it.
struct PlaneCandidate {
  PlaneEquation plane;
  std::vector<int> inliers;  ///< indices into KeyframePoints
  double eps = 0.0;          ///< its own inlier distance (own_eps)
  int label = 0;             ///< of the mask that it was found in, 0 = none
};

/// Share of the inliers' nearest image neighbours that are inliers; needs shown.nearest. Where
/// normals are known [D] only neighbours that face the same way are asked: a step of a stair
/// adjoins what faces another way all along.
double coherence(const KeyframePoints& shown, const PlaneCandidate& candidate);

/// Drops inliers that lie amid others in the image; needs shown.nearest.
void keep_coherent(const KeyframePoints& shown, const PlausibilityOptions& options,
                   PlaneCandidate& candidate);

/// Keeps the largest patch: what lies across a gap may be another plane of the same height. Of a
/// mask, which says that it is not, only strays are dropped.
void keep_connected(const KeyframePoints& shown, const PlaneScale& scale,
                    PlaneCandidate& candidate);

/// Whether of the points that no plane owns in the slab about the inliers (of the candidate's mask,
/// if it has one) most face the plane's way, where their normal is known; and whether that is so of
/// many where a candidate of a mask is as thick as eps_d. True without normals.
bool is_faced(const KeyframePoints& shown, const PlaneCandidate& candidate, const PlaneScale& scale,
              const PlausibilityOptions& options);

/// Neither a line of points nor seen edge-on.
bool is_broad(const KeyframePoints& shown, const PlaneCandidate& candidate,
              const PlausibilityOptions& options);

/// Points on a plane and those that are seen through it: behind it, by one to four times `eps` over
/// band, where their mean viewing ray crosses it between two that are on it. An opaque plane has
/// strays there alone; a slab cut out of clutter has what it was cut from.
struct SeenThrough {
  int on_plane = 0;
  int through = 0;
};
SeenThrough count_seen_through(const PlaneEquation& plane, const PlanePoints& points, double eps,
                               const PlaneScale& scale);

/// Density of points in the band over that beside it, over the same patch; infinite where nothing
/// is beside. Beside it count the points that no plane owns or one that is nearly parallel, so that
/// no second layer is laid over a noisy plane; of an image with masks those of the same instance
/// alone, which are what the mask claims to be on the plane.
double contrast(const Map& map, const KeyframePoints& shown, const PlaneCandidate& candidate,
                const PlaneScale& scale);

}  // namespace planecast::slam
