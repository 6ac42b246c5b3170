#include "slam/stages/plane_by_patches.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>
#include <vector>

#include "slam/features/patch.h"
#include "slam/features/pyramid.h"
#include "slam/features/warp_patch.h"
#include "slam/fitting/plane_mixture.h"
#include "slam/geometry/change_of_view.h"
#include "slam/geometry/lens.h"

namespace planecast::slam {

namespace {

/// A spot of the plane in the camera that sees it as it is.
struct Spot {
  Eigen::Vector3d ray;    ///< (x, y, 1)
  Eigen::Vector3d point;  ///< on the plane
  Eigen::Vector3d normal;
  Keypoint keypoint;
};

/// Where another keyframe sees a spot.
struct SpotSight {
  Pose cam_from_own;
  Eigen::Vector2d pixel;  ///< undistorted
};

std::optional<Spot> spot_of(const Plane& plane, const Keyframe& own, const Eigen::Vector3f& anchor,
                            const Camera& camera, int octave) {
  Spot spot;
  const Eigen::Vector3d point = anchor.cast<double>();
  spot.ray = point / point.z();
  spot.normal = own.cam_from_world.linear() * plane.normal;
  const double slope = spot.normal.dot(spot.ray);
  const double z = -plane.signed_distance(own.centre_world()) / slope;
  if (!(slope < 0.0) || !(z > 0.0)) return std::nullopt;
  spot.point = z * spot.ray;
  spot.keypoint.raw = project_raw(camera, spot.ray).cast<float>();
  spot.keypoint.pixel = camera.project(spot.ray).cast<float>();
  spot.keypoint.octave = octave;
  return spot;
}

std::optional<SpotSight> find(const Spot& spot, const Keyframe& own, const Keyframe& other,
                              const Camera& camera, const PlaneByPatchesOptions& options) {
  SpotSight sight;
  sight.cam_from_own = other.cam_from_world * own.cam_from_world.inverse();
  const Eigen::Vector3d expected = sight.cam_from_own * spot.point;
  if (!(expected.z() > 0.0)) return std::nullopt;
  const auto view = change_of_view(camera, spot.point, spot.normal, sight.cam_from_own);
  if (!view) return std::nullopt;
  const auto patch = warp_patch(*own.pyramid, spot.keypoint, *view, *other.pyramid, options.levels);
  if (!patch) return std::nullopt;
  const Eigen::Vector2f start = project_raw(camera, expected).cast<float>();
  const auto aligned =
      align_patch(patch->looks, other.pyramid->levels[static_cast<std::size_t>(patch->level)],
                  at_level(start, patch->level));
  if (!aligned || aligned->correlation < options.min_correlation) return std::nullopt;
  sight.pixel = camera.undistort(from_level(aligned->pixel, patch->level).cast<double>());
  return sight;
}

/// Depth along the spot's ray by least squares over its sights; nothing where they disagree.
std::optional<double> depth_of(const Spot& spot, const std::vector<SpotSight>& sights,
                               const Camera& camera, double max_residual_px) {
  constexpr int kIterations = 4;
  double inverse = 1.0 / spot.point.z();
  double squares = 0.0;
  for (int k = 0; k < kIterations; ++k) {
    double hessian = 0.0;
    double gradient = 0.0;
    squares = 0.0;
    for (const SpotSight& sight : sights) {
      const Eigen::Vector3d shift = sight.cam_from_own.translation();
      const Eigen::Vector3d point = sight.cam_from_own.linear() * spot.ray + inverse * shift;
      if (!(point.z() > 0.0)) return std::nullopt;
      const Eigen::Vector2d residual = camera.project(point) - sight.pixel;
      const Eigen::Vector2d slope = pixel_by_point(camera, point) * shift;
      hessian += slope.squaredNorm();
      gradient += slope.dot(residual);
      squares += residual.squaredNorm();
    }
    if (!(hessian > 0.0)) return std::nullopt;
    inverse -= gradient / hessian;
  }
  const double rms = std::sqrt(squares / static_cast<double>(sights.size()));
  if (!(inverse > 0.0) || rms > max_residual_px) return std::nullopt;
  return 1.0 / inverse;
}

/// The spot where the keyframes beside its own find it, in the world.
std::optional<Eigen::Vector3d> place(const Plane& plane, const Keyframe& own,
                                     const std::vector<const Keyframe*>& beside,
                                     const Eigen::Vector3f& anchor, const Camera& camera,
                                     const PlaneByPatchesOptions& options) {
  constexpr std::size_t kFewestSights = 2;
  const auto spot = spot_of(plane, own, anchor, camera, options.octave);
  if (!spot) return std::nullopt;
  std::vector<SpotSight> sights;
  for (const Keyframe* other : beside) {
    const auto sight = find(*spot, own, *other, camera, options);
    if (sight) sights.push_back(*sight);
  }
  if (sights.size() < kFewestSights) return std::nullopt;
  const auto z = depth_of(*spot, sights, camera, options.max_residual_px);
  if (!z) return std::nullopt;
  return own.cam_from_world.inverse() * (*z * spot->ray);
}

}  // namespace

bool refit_by_patches(const Map& map, Plane& plane, const PlaneSupport& support,
                      const PlaneContext& context, const PlaneByPatchesOptions& options) {
  PlanePoints points;
  points.positions.assign(
      support.points.positions.begin(),
      support.points.positions.begin() + static_cast<std::ptrdiff_t>(support.landmarks.size()));
  const std::size_t step = std::max<std::size_t>(
      1, plane.depth_anchors.size() / static_cast<std::size_t>(options.samples));
  const Keyframe* own = nullptr;
  std::vector<const Keyframe*> beside;
  for (std::size_t i = 0; i < plane.depth_anchors.size(); i += step) {
    const DepthAnchor& anchor = plane.depth_anchors[i];
    const Keyframe* seen_by = map.keyframes.find(anchor.keyframe);
    if (seen_by == nullptr || seen_by->pyramid == nullptr) continue;
    if (seen_by != own) beside = keyframes_beside(map, *seen_by, options.beside);
    own = seen_by;
    const auto found = place(plane, *own, beside, anchor.point_cam, context.camera, options);
    if (found) points.positions.push_back(*found);
  }
  if (points.size() < options.fewest) return false;
  std::vector<int> all(static_cast<std::size_t>(points.size()));
  std::iota(all.begin(), all.end(), 0);
  const auto fitted = fit_plane_mixture(points, all, PlaneEquation{plane.normal, plane.offset},
                                        mixture_options(context.scale));
  if (!fitted) return false;
  plane.refit(fitted->plane.normal, fitted->plane.offset);
  return true;
}

}  // namespace planecast::slam
