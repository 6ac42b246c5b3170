#include "engine/evaluate/tracks.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "engine/channels.h"
#include "engine/evaluate/trajectory.h"
#include "engine/scene/hit_test.h"
#include "engine/scene/placement.h"
#include "engine/scene/plane_outline.h"
#include "engine/user_error.h"
#include "slam/features/patch.h"

namespace planecast::engine {
namespace {

/// A frame's grey picture, its half and its quarter: the smaller ones show more of what surrounds a
/// patch, so that it is found from farther away and not mistaken for another that looks like it.
using PictureSizes = std::array<cv::Mat, 3>;

PictureSizes to_pictures(const cv::Mat& image) {
  PictureSizes pictures;
  pictures[0] = to_grey(image);
  for (std::size_t i = 1; i < pictures.size(); ++i) {
    cv::resize(pictures[i - 1], pictures[i], cv::Size(), 0.5, 0.5, cv::INTER_AREA);
  }
  return pictures;
}

/// Pixel of the picture halved so many times, and back; pixel centres are integers in all.
Eigen::Vector2f reduced(const Eigen::Vector2f& pixel, std::size_t times) {
  const float scale = std::ldexp(1.0F, -static_cast<int>(times));
  return ((pixel.array() + 0.5F) * scale - 0.5F).matrix();
}
Eigen::Vector2f enlarged(const Eigen::Vector2f& pixel, std::size_t times) {
  const float scale = std::ldexp(1.0F, static_cast<int>(times));
  return ((pixel.array() + 0.5F) * scale - 0.5F).matrix();
}

struct AnchoredPoint {
  Eigen::Vector2d pixel;  ///< raw, in the anchors' frame
  Eigen::Vector3d position;
};

struct AnchorFrame {
  const FrameRecord* record = nullptr;
  const PlaneRecord* plane = nullptr;
  PictureSizes pictures;
  std::vector<AnchoredPoint> points;
};

/// Signed distance, positive on the side that the normal shows to.
double height_over(const PlaneRecord& plane, const Eigen::Vector3d& point) {
  return plane.normal.dot(point) + plane.offset;
}

std::optional<Eigen::Vector3d> on_plane(const PlaneRecord& plane, const Ray& ray) {
  const double slope = plane.normal.dot(ray.direction);
  if (std::abs(slope) < 1e-9) return std::nullopt;
  const double along = -height_over(plane, ray.origin) / slope;
  if (along <= 0.0) return std::nullopt;
  return ray.origin + along * ray.direction;
}

struct SeenPoint {
  Eigen::Vector2d pixel;  ///< raw
  double z = 0.0;
};

/// Where a world point is seen; nothing behind the camera.
std::optional<SeenPoint> seen_from(const slam::Camera& camera, const slam::Pose& cam_from_world,
                                   const Eigen::Vector3d& point) {
  const Eigen::Vector3d p = cam_from_world * point;
  if (p.z() <= 0.0) return std::nullopt;
  return SeenPoint{camera.distort(camera.project(p)), p.z()};
}

std::optional<Eigen::Vector2d> raw_pixel(const slam::Camera& camera, const slam::Pose& pose,
                                         const Eigen::Vector3d& point) {
  const auto seen = seen_from(camera, pose.inverse(), point);
  if (!seen) return std::nullopt;
  return seen->pixel;
}

bool agrees_with_depth(const cv::Mat& depth, const slam::Pose& pose, const Eigen::Vector2d& pixel,
                       const Eigen::Vector3d& point, double tolerance) {
  if (depth.empty()) return true;
  const int x = std::clamp(static_cast<int>(std::lround(pixel.x())), 0, depth.cols - 1);
  const int y = std::clamp(static_cast<int>(std::lround(pixel.y())), 0, depth.rows - 1);
  const double measured = double{depth.at<float>(y, x)};
  const double expected = (pose.inverse() * point).z();
  return measured <= 0.0 || std::abs(measured - expected) < tolerance * expected;
}

std::vector<const FrameRecord*> posed_frames(const Reconstruction& reconstruction,
                                             const Sequence& sequence) {
  std::vector<const FrameRecord*> posed;
  for (const FrameRecord& frame : reconstruction.frames) {
    const bool in_range =
        frame.index >= sequence.first_frame() && frame.index < sequence.end_frame();
    if (frame.world_from_cam && in_range) posed.push_back(&frame);
  }
  return posed;
}

/// Where in a frame texture is known to lie on a plane: near its map points, but not near those
/// that stand above it. What lies on a desk is not the desk.
cv::Mat mask_of_plane(const Reconstruction& reconstruction, const slam::FrameInput& frame,
                      const slam::Pose& pose, const PlaneRecord& plane,
                      const TrackOptions& options) {
  const slam::Camera& camera = reconstruction.camera;
  const double side = height_over(plane, pose.translation()) > 0.0 ? 1.0 : -1.0;
  cv::Mat on_plane(frame.image.size(), CV_8UC1, cv::Scalar(0));
  cv::Mat above(frame.image.size(), CV_8UC1, cv::Scalar(0));
  for (const MapPoint& point : reconstruction.points) {
    const auto pixel = raw_pixel(camera, pose, point.position);
    if (!pixel || !camera.contains(*pixel, options.border_px)) continue;
    const double height = side * height_over(plane, point.position);
    const double distance = (point.position - pose.translation()).norm();
    const double thickness = options.thickness_share * distance;
    const bool lies_on_it =
        point.plane == plane.id && std::abs(height) <= thickness &&
        agrees_with_depth(frame.depth, pose, *pixel, point.position, options.depth_tolerance);
    if (!lies_on_it && height <= thickness) continue;
    cv::circle(lies_on_it ? on_plane : above,
               {static_cast<int>(pixel->x()), static_cast<int>(pixel->y())}, 3, cv::Scalar(255),
               cv::FILLED);
  }
  on_plane.setTo(0, above);
  return on_plane;
}

/// Textured pixels of one plane in a frame, strongest first, spread out.
std::vector<AnchoredPoint> candidates(const Reconstruction& reconstruction,
                                      const slam::FrameInput& frame, const cv::Mat& grey,
                                      const slam::Pose& pose, const PlaneRecord& plane,
                                      const TrackOptions& options) {
  std::vector<cv::Point2f> corners;
  cv::goodFeaturesToTrack(grey, corners, options.points, options.least_corner,
                          options.least_distance_px,
                          mask_of_plane(reconstruction, frame, pose, plane, options), 5);
  std::vector<AnchoredPoint> found;
  for (const cv::Point2f& corner : corners) {
    const Eigen::Vector2d pixel(corner.x, corner.y);
    const auto hit =
        hit_test(reconstruction.planes, pixel_ray(reconstruction.camera, pose, pixel), {0.0});
    if (hit && hit->plane_id == plane.id) found.push_back({pixel, hit->point});
  }
  return found;
}

std::vector<const PlaneRecord*> wanted_planes(const Reconstruction& reconstruction,
                                              const TrackOptions& options) {
  if (!options.plane.empty()) return {&select_plane(reconstruction, options.plane, "--plane")};
  std::vector<const PlaneRecord*> planes;
  for (const PlaneRecord& plane : reconstruction.planes) {
    if (plane.plane_class == "horizontal" || plane.plane_class == "floor") {
      planes.push_back(&plane);
    }
  }
  if (!planes.empty()) return planes;
  for (const PlaneRecord& plane : reconstruction.planes) planes.push_back(&plane);
  return planes;
}

AnchorFrame choose_anchors(const Reconstruction& reconstruction, Sequence& sequence,
                           const TrackOptions& options) {
  const std::vector<const FrameRecord*> posed = posed_frames(reconstruction, sequence);
  constexpr std::size_t kTried = 10;
  std::vector<const FrameRecord*> tried;
  for (std::size_t i = 0; i < posed.size(); ++i) {
    const bool in_step = i % std::max<std::size_t>(1, posed.size() / kTried) == 0;
    if (options.frame ? posed[i]->index == *options.frame : in_step) tried.push_back(posed[i]);
  }
  if (tried.empty()) {
    throw UserError(options.frame ? fmt::format("--frame {}: has no camera pose", *options.frame)
                                  : "no frame has a camera pose");
  }
  AnchorFrame best;
  for (const FrameRecord* record : tried) {
    const slam::FrameInput frame = sequence.read(record->index);
    const PictureSizes pictures = to_pictures(frame.image);
    for (const PlaneRecord* plane : wanted_planes(reconstruction, options)) {
      const auto points =
          candidates(reconstruction, frame, pictures[0], *record->world_from_cam, *plane, options);
      if (best.record != nullptr && points.size() <= best.points.size()) continue;
      best = {record, plane, pictures, points};
    }
  }
  if (best.points.empty()) throw UserError("no textured point of a plane was found to anchor");
  return best;
}

/// Derivative of the pixel in a frame by that in the anchors' frame, by way of the plane.
std::optional<Eigen::Matrix2d> frame_from_anchor(const slam::Camera& camera,
                                                 const AnchorFrame& anchor, const slam::Pose& pose,
                                                 const AnchoredPoint& point) {
  constexpr double kStep = 2.0;  // pixels
  Eigen::Matrix2d derivative;
  for (int axis = 0; axis < 2; ++axis) {
    std::array<Eigen::Vector2d, 2> seen;
    for (int side = 0; side < 2; ++side) {
      Eigen::Vector2d pixel = point.pixel;
      pixel[axis] += side == 0 ? -kStep : kStep;
      const auto world =
          on_plane(*anchor.plane, pixel_ray(camera, *anchor.record->world_from_cam, pixel));
      const auto there = world ? raw_pixel(camera, pose, *world) : std::nullopt;
      if (!there) return std::nullopt;
      seen[static_cast<std::size_t>(side)] = *there;
    }
    derivative.col(axis) = (seen[1] - seen[0]) / (2.0 * kStep);
  }
  return derivative;
}

/// Finds the patch about `pixel` of one picture in another, from that of size `coarsest` to the
/// largest; at each it must look the same.
std::optional<Eigen::Vector2f> find_patch_from(const PictureSizes& from,
                                               const Eigen::Vector2f& pixel, const PictureSizes& in,
                                               Eigen::Vector2f start,
                                               const Eigen::Matrix2f& from_per_in,
                                               std::size_t coarsest, const TrackOptions& options) {
  slam::PatchAlignOptions align;
  align.iterations = 30;
  align.max_shift_px =
      std::ldexp(static_cast<float>(options.max_shift_px), -static_cast<int>(coarsest));
  for (std::size_t i = coarsest + 1; i-- > 0;) {
    const auto patch = slam::make_template(from[i], reduced(pixel, i), from_per_in);
    if (!patch) return std::nullopt;
    const auto found = slam::align_patch(*patch, in[i], reduced(start, i), align);
    if (!found || found->correlation < static_cast<float>(options.min_correlation)) {
      return std::nullopt;
    }
    start = enlarged(found->pixel, i);
    align.max_shift_px = 2.0F;
  }
  return start;
}

/// The same from the smallest size that will do: about a point near what stands on the plane, the
/// smaller pictures show more of that than of the plane.
std::optional<Eigen::Vector2f> find_patch(const PictureSizes& from, const Eigen::Vector2f& pixel,
                                          const PictureSizes& in, const Eigen::Vector2f& start,
                                          const Eigen::Matrix2f& from_per_in,
                                          const TrackOptions& options) {
  for (std::size_t coarsest = from.size(); coarsest-- > 0;) {
    const auto found = find_patch_from(from, pixel, in, start, from_per_in, coarsest, options);
    if (found) return found;
  }
  return std::nullopt;
}

/// Compares the points in one frame.
class FrameComparison {
 public:
  FrameComparison(const Reconstruction& reconstruction, const AnchorFrame& anchor,
                  const TrackOptions& options, TracksResult& result, std::vector<double>& errors)
      : map_points_(reconstruction.points),
        camera_(reconstruction.camera),
        anchor_(anchor),
        options_(options),
        result_(result),
        errors_(errors) {}

  void add(const slam::FrameInput& frame, const slam::Pose& pose) {
    const PictureSizes pictures = to_pictures(frame.image);
    seen_.clear();
    if (frame.depth.empty()) look_at_map(pose);
    const int before = result_.visible;
    for (const AnchoredPoint& point : anchor_.points) add_point(frame, pictures, pose, point);
    result_.frames += result_.visible > before ? 1 : 0;
  }

 private:
  /// Keeps the points that are nearer than the plane behind them: those of the plane itself hide
  /// none of it, however flat it is seen.
  void look_at_map(const slam::Pose& pose) {
    const slam::Pose cam_from_world = pose.inverse();
    const PlaneRecord& plane = *anchor_.plane;
    const double camera_height = height_over(plane, pose.translation());
    for (const MapPoint& point : map_points_) {
      const auto seen = seen_from(camera_, cam_from_world, point.position);
      if (!seen || !camera_.contains(seen->pixel, 0.0)) continue;
      // On one ray, as the distances to the plane so those to the camera.
      const double nearer = height_over(plane, point.position) / camera_height;
      if (nearer > options_.hidden_share) seen_.push_back(*seen);
    }
  }

  bool is_hidden(const SeenPoint& drawn) const {
    return std::any_of(seen_.begin(), seen_.end(), [&](const SeenPoint& seen) {
      return seen.z < drawn.z && (seen.pixel - drawn.pixel).norm() < options_.hidden_px;
    });
  }

  void add_point(const slam::FrameInput& frame, const PictureSizes& pictures,
                 const slam::Pose& pose, const AnchoredPoint& point) {
    const auto drawn = seen_from(camera_, pose.inverse(), point.position);
    if (!drawn || !camera_.contains(drawn->pixel, options_.border_px)) return;
    const Eigen::Vector3d to_camera = (pose.translation() - point.position).normalized();
    const double least = std::cos(options_.max_slant_deg * std::numbers::pi / 180.0);
    if (anchor_.plane->normal.dot(to_camera) < least) return;
    if (!agrees_with_depth(frame.depth, pose, drawn->pixel, point.position,
                           options_.depth_tolerance)) {
      return;
    }
    if (is_hidden(*drawn)) return;
    const auto derivative = frame_from_anchor(camera_, anchor_, pose, point);
    if (!derivative) return;
    const double zoom = std::sqrt(std::abs(derivative->determinant()));
    if (!(zoom < options_.max_zoom && zoom > 1.0 / options_.max_zoom)) return;
    ++result_.visible;
    const Eigen::Vector2f at_anchor = point.pixel.cast<float>();
    const Eigen::Matrix2f anchor_per_frame = derivative->inverse().cast<float>();
    const auto found = find_patch(anchor_.pictures, at_anchor, pictures, drawn->pixel.cast<float>(),
                                  anchor_per_frame, options_);
    if (!found) return;
    const auto back = find_patch(pictures, *found, anchor_.pictures, at_anchor,
                                 derivative->cast<float>(), options_);
    // In pixels of the coarser of the two pictures.
    const double coarser = std::min(1.0, zoom);
    if (!back || coarser * (*back - at_anchor).norm() > options_.max_return_px) return;
    ++result_.compared;
    errors_.push_back((found->cast<double>() - drawn->pixel).norm());
  }

  const std::vector<MapPoint>& map_points_;
  const slam::Camera& camera_;
  const AnchorFrame& anchor_;
  const TrackOptions& options_;
  TracksResult& result_;
  std::vector<double>& errors_;
  std::vector<SeenPoint> seen_;  ///< of the map, in the frame at hand
};

}  // namespace

TracksResult evaluate_tracks(const Reconstruction& reconstruction, Sequence& sequence,
                             const TrackOptions& options) {
  const AnchorFrame anchor = choose_anchors(reconstruction, sequence, options);
  TracksResult result;
  result.frame = anchor.record->index;
  result.plane_id = anchor.plane->id;
  result.points = static_cast<int>(anchor.points.size());
  std::vector<double> errors;
  FrameComparison comparison(reconstruction, anchor, options, result, errors);
  for (const FrameRecord* frame : posed_frames(reconstruction, sequence)) {
    if (frame->index == result.frame) continue;
    comparison.add(sequence.read(frame->index), *frame->world_from_cam);
  }
  result.error_px = statistics_of(errors);
  return result;
}

std::string format_table(const TracksResult& result) {
  return fmt::format(
      "{} points of plane {} anchored at frame {}, {} other frames\n"
      "compared {} of {} visible ({:.1f} %)\n"
      "{:10} {:>10} {:>10} {:>10} {:>10}\n{:10} {:>10.3f} {:>10.3f} {:>10.3f} {:>10.3f}\n",
      result.points, result.plane_id, result.frame, result.frames, result.compared, result.visible,
      100.0 * result.compared_share(), "error px", "rms", "median", "p95", "max", "tracks",
      result.error_px.rms, result.error_px.median, result.error_px.p95, result.error_px.max);
}

nlohmann::ordered_json to_json(const TracksResult& result) {
  nlohmann::ordered_json json;
  json["frame"] = result.frame;
  json["plane"] = result.plane_id;
  json["points"] = result.points;
  json["frames"] = result.frames;
  json["visible"] = result.visible;
  json["compared"] = result.compared;
  json["compared_share"] = result.compared_share();
  json["error_px"] = to_json(result.error_px);
  return json;
}

}  // namespace planecast::engine
