#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "slam/stages/plane_points.h"

namespace planecast::slam {

/// The steps of PlaneMapper, in the order in which local mapping runs them.

/// Removes from the map the keyframe's landmarks that own a plane but are farther from it than
/// their band. [D] Where more than 40 % of a plane's landmarks fail, the plane is at fault: it is
/// refitted first, and landmarks that then still fail are let go, not removed. Returns the number
/// removed.
int cull_far_landmarks(Map& map, KeyframeId keyframe, const PlaneContext& context);

/// A plane as it grows during one keyframe.
struct GrowingPlane {
  PlaneId plane = kNone;
  std::vector<Eigen::Vector3d> support;  ///< evenly chosen, and what has joined since
  Eigen::Vector3d low, high;             ///< box about it
  double eps = 0.0;                      ///< own_eps
  std::optional<double> link;            ///< link_of, once it was needed
};
/// Adds the planes of the map that `planes` lacks.
void prepare_growth(const Map& map, const PlaneContext& context, std::vector<GrowingPlane>& planes);

/// Unowned points of the keyframe within their band of a plane join it if they were seen from its
/// normal's side, lie next to its support and, where there are masks, are in a mask that is this
/// plane's. Counts planes that gain nothing as stalled. Returns the number of landmarks that
/// joined.
int expand_planes(Map& map, KeyframeId keyframe, const PlaneContext& context, KeyframePoints& shown,
                  std::vector<GrowingPlane>& planes);

/// Judges by coherence and contrast whether the planes in an image without masks still look like
/// planes, and counts in Plane::doubts where not.
void doubt_planes(Map& map, const PlaneContext& context, const KeyframePoints& shown);

/// Ages every plane by a keyframe, drops weak ones that have stalled for too long and those that
/// have lost their support have become thicker than 1.5 eps_Pi or were doubted too often. Returns
/// the number dropped.
int drop_weak_planes(Map& map, const PlaneContext& context);

/// New planes from the points that no plane owns: one fit per mask instance, or sequential fits
/// where the image was not segmented. Returns their number.
int find_planes(Map& map, KeyframeId keyframe, const PlaneContext& context, KeyframePoints& shown);

/// Merges planes that are the same; the lower id survives with its frame. Planes of one height
/// whose parts lie apart are the same only where a mask of this keyframe covers both. Returns the
/// number merged away.
int merge_planes(Map& map, const PlaneContext& context, const KeyframePoints& shown);

/// New equations for the planes that the keyframe sees: the best of least-squares fits to random 60
/// % subsets of the support, taken only if it beats the present one. Support that is then farther
/// than 1.5 bands is let go. Returns the number of planes changed.
int reestimate_planes(Map& map, KeyframeId keyframe, const PlaneContext& context);

struct RefineCounts {
  int refined = 0;
  int refused = 0;
};
/// Projects the landmarks of the planes that the keyframe sees onto their plane, along the normal
/// by the signed distance, each only if its reprojection then still passes chi2 in every keyframe
/// that sees it.
RefineCounts project_landmarks(Map& map, KeyframeId keyframe, const PlaneContext& context);

/// [D] Refits every plane of a finished map to what is most alike in it: the likeliest sheet of the
/// least thickness, with next to nothing behind it, by the landmarks about it. Returns the number
/// of planes changed.
int settle_planes(Map& map, const PlaneContext& context);

/// Refits every plane to its support after the map has moved; depth points follow their keyframes.
void refit_planes(Map& map, const PlaneContext& context);

/// Least squares on the support, then again on what lies within three median distances or the band.
/// False where the support is no plane (too few points, on a line); the plane stays as it was.
bool refit_robustly(Plane& plane, const PlaneSupport& support, const PlaneContext& context);

}  // namespace planecast::slam
