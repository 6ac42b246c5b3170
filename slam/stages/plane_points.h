#pragma once

#include <Eigen/Core>
#include <vector>

#include "slam/data/camera.h"
#include "slam/data/map.h"
#include "slam/fitting/neighbourhood.h"
#include "slam/fitting/plane_mixture.h"
#include "slam/fitting/plane_model.h"
#include "slam/stages/map_planes.h"

namespace planecast::slam {

/// What every plane step needs to know.
struct PlaneContext {
  PlaneMappingOptions options;
  PlaneScale scale;
  Camera camera;
  bool rgbd = false;   ///< keyframes have depth
  bool young = false;  ///< so few keyframes that no plane of the map can be thin yet
  /// [D] No keyframe will come: an image shows its landmarks that were not found in it as well, and
  /// a plane is strong by fewer of them, since their depths are as good as they get.
  bool finished = false;
  /// [D] Depth is that of pairs of keyframes (stereo_depth.h), in map units. At a median depth of
  /// 2.5 units of `metre` it is as precise as a sensor's at 2.5 m.
  bool stereo = false;
  double metre = 1.0;        ///< in map units
  PlaneId fixed_planes = 0;  ///< planes of lower ids keep their equations, and stay
};

/// Standard deviation, in map units, of a keyframe's depth at z.
double depth_sigma(const PlaneContext& context, double z);

/// A point's inlier band, as a multiple of eps_d: with depth max(eps_d, 3 sigma_z(z)) at depth z,
/// bounded to 2.5 eps_d, beyond which depth is too vague to tell planes; without: 1.
double band_of(const PlaneContext& context, double z);

/// band_of a landmark, at its depth in the first keyframe that sees it.
double band_of_landmark(const Map& map, const Landmark& landmark, const PlaneContext& context);

/// Whether depth at z is vaguer than the widest band, so that it tells no plane.
bool is_too_vague(const PlaneContext& context, double z);

/// What one keyframe shows that planes can be made of: its landmarks and, in RGB-D, samples of its
/// depth on a coarse grid. [D] Where there are masks, also the landmarks that lie in one of them
/// but were not found again in this keyframe: a mask shows a surface that few features lie on at
/// once. All vectors are parallel.
struct KeyframePoints {
  PlanePoints points;
  std::vector<LandmarkId> landmark;        ///< kNone: a depth sample
  std::vector<PlaneId> plane;              ///< that owns the landmark, or has taken the sample
  std::vector<int> label;                  ///< mask instance, 0 = none
  std::vector<Eigen::Vector3d> pixel;      ///< undistorted, third coordinate 0
  std::vector<Eigen::Vector3f> point_cam;  ///< of depth samples
  /// [D] RGB-D: of the surface about the point, in the world, towards the camera; zero: not known.
  std::vector<Eigen::Vector3d> normal;
  bool has_normals = false;
  NearestTable nearest;    ///< in the image; only where there are no masks
  bool has_masks = false;  ///< somebody segmented this image
  int observed = 0;        ///< the first so many were seen in the keyframe itself

  int size() const { return points.size(); }
  /// Whether the surface about point i may face this way; true where its normal is not known.
  bool may_face(int i, const Eigen::Vector3d& direction) const;
};
KeyframePoints gather_points(const Map& map, KeyframeId keyframe, const PlaneContext& context);

/// Everything that supports a plane: its landmarks first, then its depth points.
struct PlaneSupport {
  PlanePoints points;
  std::vector<LandmarkId> landmarks;  ///< of the first landmarks.size() points
};
/// Support of all planes by plane id (empty for ids that are gone), in one pass over the landmarks.
std::vector<PlaneSupport> gather_support(const Map& map, const PlaneContext& context);

/// Inlier distance of one plane for points of band 1 [D]: three standard deviations, told robustly
/// by the median, of its support's distances over their bands, between kTightest and 1 times eps_d.
/// Support that fills a slab evenly keeps eps_d; a plane that is thinner is held to what it is, so
/// that steps, books and the like beside it stay out.
double own_eps(const PlaneEquation& plane, const PlanePoints& support, const PlaneScale& scale);
/// The same of a deviation that is known.
double eps_of_sigma(double sigma, const PlaneScale& scale);

/// Whether the support is thinner than the slab that it was cut out by [D]. What fills the slab may
/// be things that stand about: nothing is moved onto such a plane, or it would make itself true.
bool is_sharp(double own_eps, const PlaneScale& scale);

/// Whether a plane is as thick as the slab it was cut out by, in a map old enough for it to be
/// thin: it stays weak, unless the map is finished and many are on it, for the slab is a thin one
/// then. A mask alone is no excuse [D], what leaked into it may be clutter; mask and
/// depth together are, since a sensor bends what is far.
bool may_be_slab(const Plane& plane, const PlanePoints& support, const PlaneContext& context);

/// How a plane is told from what stands before it: among the points up to 2 eps_d off, with a
/// deviation between a third of the tightest own_eps and eps_Pi.
PlaneMixtureOptions mixture_options(const PlaneScale& scale);

/// Support below which the plane is weak. [D] Twice the option for one that was found without a
/// mask and so has no second witness, four fifths of it in a finished map; three fifths for one
/// with a mask that five keyframes have confirmed.
int strong_support(const Plane& plane, const PlaneContext& context);

/// Keyframes that must have seen a plane before it is more than weak. [D] One view of a monocular
/// map is no evidence: its landmarks' errors run along the same rays.
int least_observers(const Plane& plane, const PlaneContext& context);

/// Weighted RMS and landmark count into the plane, whether it is weak, from its support.
void update_figures(Plane& plane, const PlaneSupport& support, const PlaneContext& context);

/// Adds a depth sample to the plane.
void add_depth_point(Plane& plane, KeyframeId keyframe, const Eigen::Vector3d& position,
                     const Eigen::Vector3f& point_cam);
/// Where there are more than 1.5 times `most` depth points, thins them to at most `most`, evenly
/// over the plane: one per cell of a grid that is made coarser until they fit; the latest stay.
void bound_depth_points(Plane& plane, int most, double cell);

/// Disowns the plane's landmarks and erases it.
void erase_plane(Map& map, PlaneId plane);

/// Distance within which points of a plane count as connected, from its support's spacing, between
/// 2 and 6 eps_d.
double link_of(const std::vector<Eigen::Vector3d>& support, const PlaneScale& scale);
/// The same where a mask says that the points are of one surface [D]: without the upper bound, for
/// features may be few and far between on it.
double link_in_mask(const std::vector<Eigen::Vector3d>& support, const PlaneScale& scale);

}  // namespace planecast::slam
