#include "engine/evaluate/overlay.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "engine/evaluate/patch.h"
#include "engine/evaluate/plane_matching.h"
#include "engine/scene/hit_test.h"
#include "engine/scene/plane_motion.h"
#include "engine/scene/plane_outline.h"

namespace planecast::engine {
namespace {

/// Estimated points nearer to the camera than this are not drawn.
constexpr double kNearest = 1e-6;

/// A frame for which both poses are known.
struct View {
  int frame_index = 0;
  std::size_t position = 0;  ///< in the reconstruction's frames
  slam::Pose estimate;       ///< world_from_cam
  slam::Pose truth;
};

/// One grid point in the true world and its two counterparts in the estimated plane's own frame.
struct GridPoint {
  Eigen::Vector3d truth;
  Eigen::Vector3d normal;  ///< of the true plane
  std::optional<Eigen::Vector3d> aligned;
  std::optional<Eigen::Vector3d> tapped;
  Tap tap;
};

using ViewPoses = std::vector<std::optional<slam::Pose>>;  ///< by view

/// An estimated plane with its own frame's pose in each view; nothing where it was not known.
struct TrackedPlane {
  const PlaneRecord& record;
  ViewPoses world_from_plane;
};

using Errors = std::vector<std::optional<Eigen::Vector2d>>;  ///< of one point by view

std::vector<View> common_views(const Reconstruction& estimate,
                               const std::vector<TimedPose>& truth_poses,
                               const OverlayOptions& options) {
  std::vector<TimedPose> poses;
  std::vector<std::size_t> positions;
  for (std::size_t i = 0; i < estimate.frames.size(); ++i) {
    const FrameRecord& frame = estimate.frames[i];
    const auto& pose = options.causal ? frame.causal_world_from_cam : frame.world_from_cam;
    if (!pose) continue;
    poses.push_back({frame.timestamp, *pose});
    positions.push_back(i);
  }
  std::vector<View> views;
  for (const auto& [e, t] :
       associate(poses, truth_poses, options.planes.trajectory.max_difference_s)) {
    const std::size_t position = positions[static_cast<std::size_t>(e)];
    views.push_back({estimate.frames[position].index, position,
                     poses[static_cast<std::size_t>(e)].world_from_cam,
                     truth_poses[static_cast<std::size_t>(t)].world_from_cam});
  }
  return views;
}

slam::Similarity inverse(const slam::Similarity& s) {
  slam::Similarity inverted;
  inverted.scale = 1.0 / s.scale;
  inverted.rotation = s.rotation.transpose();
  inverted.translation = -inverted.scale * (inverted.rotation * s.translation);
  return inverted;
}

bool is_seen(const GridPoint& point, const View& view, const slam::Camera& camera) {
  return point.normal.dot(view.truth.translation() - point.truth) > 0.0 &&
         is_in_view(view.truth, camera, point.truth);
}

/// Where a tap puts content, in the estimated plane's frame; nothing where it meets another plane
/// or none.
std::optional<Eigen::Vector3d> tap_point(const View& view, const Tap& tap,
                                         const std::vector<PlaneRecord>& planes, int plane_id) {
  const Ray ray{view.estimate.translation(), view.estimate.linear() * tap.direction_cam};
  const std::optional<Hit> hit = hit_test(planes, ray);
  if (!hit || hit->plane_id != plane_id) return std::nullopt;
  return find_plane(planes, plane_id)->world_from_plane().inverse() * hit->point;
}

TrackedPlane track_plane(const PlaneRecord& plane, const std::vector<View>& views,
                         const PlaneMotion* motion) {
  TrackedPlane tracked{plane, {}};
  for (const View& view : views) {
    tracked.world_from_plane.push_back(motion != nullptr
                                           ? motion->world_from_plane(plane.id, view.frame_index)
                                           : std::optional(plane.world_from_plane()));
  }
  return tracked;
}

/// The plane's frame in each view as what was put there by the tap follows it.
ViewPoses under_tap(const GridPoint& point, const TrackedPlane& plane,
                    const std::vector<View>& views, const PlaneMotion* motion) {
  if (motion == nullptr || !point.tapped) return plane.world_from_plane;
  const ViewPoses by_frame = motion->world_from_plane_under(point.tap, plane.record.id);
  ViewPoses poses;
  for (const View& view : views) poses.push_back(by_frame[view.position]);
  return poses;
}

std::vector<GridPoint> lay_grid(const PlaneRecord& truth, const TrackedPlane& estimate,
                                const slam::Similarity& estimate_from_truth,
                                const std::vector<View>& views, const slam::Camera& true_camera,
                                const Reconstruction& map, const OverlayOptions& options) {
  const slam::Pose plane_from_world = estimate.record.world_from_plane().inverse();
  std::vector<GridPoint> grid;
  for (const Eigen::Vector3d& position : Patch(truth).grid(options.grid_cells)) {
    GridPoint point{position, truth.normal, std::nullopt, std::nullopt, {}};
    const Eigen::Vector3d over = plane_from_world * (estimate_from_truth * position);
    point.aligned = Eigen::Vector3d(over.x(), over.y(), 0.0);
    grid.push_back(point);
  }
  std::vector<bool> seen(grid.size(), false);
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (!estimate.world_from_plane[i]) continue;
    std::vector<PlaneRecord> planes;
    for (std::size_t k = 0; k < grid.size(); ++k) {
      if (seen[k] || !is_seen(grid[k], views[i], true_camera)) continue;
      if (planes.empty()) planes = planes_at(map, views[i].frame_index, options.causal);
      const Eigen::Vector3d seen_at = views[i].truth.inverse() * grid[k].truth;
      grid[k].tap = {views[i].frame_index, map.camera.ray(true_camera.project(seen_at))};
      grid[k].tapped = tap_point(views[i], grid[k].tap, planes, estimate.record.id);
      seen[k] = true;
    }
  }
  return grid;
}

Errors errors_of(const GridPoint& point, const std::optional<Eigen::Vector3d>& anchor,
                 const ViewPoses& world_from_plane, const std::vector<View>& views,
                 const slam::Camera& true_camera, const slam::Camera& camera) {
  Errors errors(views.size());
  if (!anchor) return errors;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (!world_from_plane[i] || !is_seen(point, views[i], true_camera)) continue;
    const Eigen::Vector3d drawn = views[i].estimate.inverse() * (*world_from_plane[i] * *anchor);
    if (drawn.z() <= kNearest) continue;
    errors[i] = camera.project(drawn) - true_camera.project(views[i].truth.inverse() * point.truth);
  }
  return errors;
}

/// Collects the errors of every grid point under one way to anchor.
class DriftCollector {
 public:
  explicit DriftCollector(const std::vector<View>& views)
      : views_(views), sum_of_squares_(views.size(), 0.0), count_(views.size(), 0) {}

  void add(const Errors& errors) {
    for (std::size_t i = 0; i < errors.size(); ++i) {
      if (!errors[i]) continue;
      drift_.push_back(errors[i]->norm());
      sum_of_squares_[i] += errors[i]->squaredNorm();
      ++count_[i];
      if (i < 2 || !errors[i - 1] || !errors[i - 2]) continue;
      if (views_[i].frame_index - views_[i - 2].frame_index != 2) continue;
      jitter_.push_back((*errors[i] - 2.0 * *errors[i - 1] + *errors[i - 2]).norm());
    }
  }
  DriftFigures figures() const { return {statistics_of(drift_), statistics_of(jitter_)}; }
  int count(std::size_t view) const { return count_[view]; }
  double rms(std::size_t view) const {
    return count_[view] > 0 ? std::sqrt(sum_of_squares_[view] / count_[view]) : 0.0;
  }

 private:
  const std::vector<View>& views_;
  std::vector<double> drift_;
  std::vector<double> jitter_;
  std::vector<double> sum_of_squares_;
  std::vector<int> count_;
};

const PlaneRecord* plane_of(const std::vector<PlaneRecord>& planes, int id) {
  const auto found = std::find_if(planes.begin(), planes.end(),
                                  [id](const PlaneRecord& plane) { return plane.id == id; });
  return found == planes.end() ? nullptr : &*found;
}

}  // namespace

std::optional<OverlayResult> evaluate_overlay(const Reconstruction& estimate,
                                              const std::vector<PlaneRecord>& truth,
                                              const std::vector<TimedPose>& truth_poses,
                                              const slam::Camera& true_camera,
                                              const OverlayOptions& options) {
  const auto matches = evaluate_planes(estimate, truth, truth_poses, true_camera, options.planes);
  if (!matches) return std::nullopt;
  const std::vector<View> views = common_views(estimate, truth_poses, options);
  const slam::Similarity estimate_from_truth =
      inverse(matches->trajectory.truth_from_estimate_by_poses);
  std::optional<PlaneMotion> motion;
  if (options.causal) motion.emplace(estimate, options.ease_frames);
  OverlayResult result;
  DriftCollector aligned(views);
  DriftCollector tapped(views);
  for (const TruePlaneRow& row : matches->rows) {
    // A scale of 0 (a truth that never moves) cannot be undone.
    if (!row.matched || !(matches->trajectory.truth_from_estimate.scale > 0.0)) continue;
    const PlaneRecord* true_plane = plane_of(truth, row.truth_id);
    const PlaneMotion* moving = motion ? &*motion : nullptr;
    const TrackedPlane plane =
        track_plane(*plane_of(estimate.planes, row.estimate_id), views, moving);
    ++result.planes;
    for (const GridPoint& point :
         lay_grid(*true_plane, plane, estimate_from_truth, views, true_camera, estimate, options)) {
      aligned.add(errors_of(point, point.aligned, plane.world_from_plane, views, true_camera,
                            estimate.camera));
      tapped.add(errors_of(point, point.tapped, under_tap(point, plane, views, moving), views,
                           true_camera, estimate.camera));
    }
  }
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (aligned.count(i) == 0) continue;
    ++result.frames;
    result.per_frame.push_back(
        {views[i].frame_index, aligned.count(i), aligned.rms(i), tapped.rms(i)});
  }
  result.aligned = aligned.figures();
  result.tapped = tapped.figures();
  return result;
}

std::string format_table(const OverlayResult& result) {
  std::string text =
      fmt::format("{} planes, {} frames\n{:10} {:>10} {:>10} {:>10} {:>12} {:>12}\n", result.planes,
                  result.frames, "drift px", "rms", "p95", "max", "jitter rms", "jitter p95");
  const auto row = [](const char* name, const DriftFigures& figures) {
    return fmt::format("{:10} {:>10.3f} {:>10.3f} {:>10.3f} {:>12.3f} {:>12.3f}\n", name,
                       figures.drift_px.rms, figures.drift_px.p95, figures.drift_px.max,
                       figures.jitter_px.rms, figures.jitter_px.p95);
  };
  if (result.planes == 0) return "no plane of the estimate matches a true one\n";
  return text + row("aligned", result.aligned) + row("tapped", result.tapped);
}

nlohmann::ordered_json to_json(const OverlayResult& result) {
  const auto figures = [](const DriftFigures& from) {
    nlohmann::ordered_json json;
    json["drift_px"] = to_json(from.drift_px);
    json["jitter_px"] = to_json(from.jitter_px);
    return json;
  };
  nlohmann::ordered_json json;
  json["planes"] = result.planes;
  json["frames"] = result.frames;
  json["aligned"] = figures(result.aligned);
  json["tapped"] = figures(result.tapped);
  json["per_frame"] = nlohmann::ordered_json::array();
  for (const FrameDrift& frame : result.per_frame) {
    nlohmann::ordered_json row;
    row["frame"] = frame.frame_index;
    row["points"] = frame.points;
    row["aligned_rms_px"] = frame.aligned_rms_px;
    row["tapped_rms_px"] = frame.tapped_rms_px;
    json["per_frame"].push_back(std::move(row));
  }
  return json;
}

}  // namespace planecast::engine
