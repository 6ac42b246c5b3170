#include "engine/scene/markers.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <set>

#include "engine/channels.h"
#include "engine/marker_dictionary.h"
#include "engine/scene/hit_test.h"
#include "engine/scene/plane_outline.h"
#include "engine/user_error.h"

namespace planecast::engine {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// One picture that shows a marker.
struct View {
  slam::Pose world_from_cam;
  std::array<Ray, 4> corners;
};

/// Point nearest to the rays, each weighed by its own distance, so that far views, whose pixels
/// are wider there, count less. Nothing where they are nearly parallel.
std::optional<Eigen::Vector3d> meet(const std::vector<Ray>& rays, double least_parallax_deg) {
  std::vector<double> distances(rays.size(), 1.0);
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  for (int round = 0; round < 3; ++round) {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    double weights = 0.0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Eigen::Vector3d d = rays[i].direction.normalized();
      const double weight = 1.0 / (distances[i] * distances[i]);
      const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - d * d.transpose();
      sum += weight * across;
      right += weight * across * rays[i].origin;
      weights += weight;
    }
    // The mean of sin^2 of the angles to the mean ray: 0 for parallel rays.
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spread(sum);
    const double least = std::sin(0.5 * least_parallax_deg * kDegree);
    if (spread.eigenvalues()[0] < weights * least * least) return std::nullopt;
    point = spread.eigenvectors() * spread.eigenvalues().cwiseInverse().asDiagonal() *
            spread.eigenvectors().transpose() * right;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      distances[i] = std::max((point - rays[i].origin).norm(), 1e-9);
    }
  }
  return point;
}

using Corners = std::array<Eigen::Vector3d, 4>;

std::optional<Corners> free_corners(const std::vector<View>& views, double least_parallax_deg) {
  Corners corners;
  for (std::size_t k = 0; k < 4; ++k) {
    std::vector<Ray> rays;
    for (const View& view : views) rays.push_back(view.corners[k]);
    const std::optional<Eigen::Vector3d> corner = meet(rays, least_parallax_deg);
    if (!corner) return std::nullopt;
    corners[k] = *corner;
  }
  return corners;
}

/// Mean of where the rays meet the plane; views from behind or along it do not count.
std::optional<Corners> corners_on(const PlaneRecord& plane, const std::vector<View>& views) {
  constexpr double kLeastSlope = 0.1;
  Corners sum;
  sum.fill(Eigen::Vector3d::Zero());
  int count = 0;
  for (const View& view : views) {
    Corners met;
    bool all = true;
    for (std::size_t k = 0; k < 4; ++k) {
      const Ray& ray = view.corners[k];
      const double slope = plane.normal.dot(ray.direction);
      all = all && slope < -kLeastSlope * ray.direction.norm();
      met[k] = ray.origin - (plane.normal.dot(ray.origin) + plane.offset) / slope * ray.direction;
    }
    if (!all) continue;
    for (std::size_t k = 0; k < 4; ++k) sum[k] += met[k];
    ++count;
  }
  if (count == 0) return std::nullopt;
  for (Eigen::Vector3d& corner : sum) corner /= count;
  return sum;
}

Ray centre_ray(const View& view) {
  Ray ray{view.corners[0].origin, Eigen::Vector3d::Zero()};
  for (const Ray& corner : view.corners) ray.direction += 0.25 * corner.direction;
  return ray;
}

/// The plane that most views see behind the marker.
const PlaneRecord* voted_plane(const Reconstruction& reconstruction,
                               const std::vector<View>& views) {
  std::map<int, int> votes;
  for (const View& view : views) {
    if (const auto hit = hit_test(reconstruction.planes, centre_ray(view))) ++votes[hit->plane_id];
  }
  const auto best = std::ranges::max_element(
      votes, [](const auto& a, const auto& b) { return a.second < b.second; });
  if (best == votes.end() || 2 * best->second < static_cast<int>(views.size())) return nullptr;
  return find_plane(reconstruction.planes, best->first);
}

std::optional<FoundMarker> locate(const Reconstruction& reconstruction,
                                  const std::vector<View>& views, const MarkerOptions& options) {
  FoundMarker found;
  found.views = static_cast<int>(views.size());
  const std::optional<Corners> free = free_corners(views, options.least_parallax_deg);
  if (free) found.corners = *free;
  const PlaneRecord* plane = voted_plane(reconstruction, views);
  const std::optional<Corners> flat = plane != nullptr ? corners_on(*plane, views) : std::nullopt;
  if (!flat) return free ? std::optional(found) : std::nullopt;
  if (free) {
    const double away = std::abs(plane->normal.dot(found.centre()) + plane->offset);
    const double viewing = (found.centre() - views.front().world_from_cam.translation()).norm();
    const bool on_it =
        away < options.near_plane_share * viewing &&
        plane->normal.dot(found.normal()) > std::cos(options.near_plane_deg * kDegree);
    if (!on_it) return found;
  }
  found.corners = *flat;
  found.plane_id = plane->id;
  return found;
}

void look(const cv::Mat& image, const std::string& dictionary, const slam::Camera& camera,
          const slam::Pose& world_from_cam, std::map<MarkerId, std::vector<View>>& views) {
  const auto parameters = cv::aruco::DetectorParameters::create();
  parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_SUBPIX;
  std::vector<std::vector<cv::Point2f>> corners;
  std::vector<int> ids;
  cv::aruco::detectMarkers(image, marker_dictionary(dictionary), corners, ids, parameters);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const auto entry = views.find({dictionary, ids[i]});
    if (entry == views.end()) continue;
    View view;
    view.world_from_cam = world_from_cam;
    for (std::size_t k = 0; k < 4; ++k) {
      view.corners[k] = pixel_ray(camera, world_from_cam, {corners[i][k].x, corners[i][k].y});
    }
    entry->second.push_back(view);
  }
}

}  // namespace

Eigen::Vector3d FoundMarker::centre() const {
  return 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
}

Eigen::Vector3d FoundMarker::x_axis() const {
  return (corners[1] + corners[2] - corners[0] - corners[3]).normalized();
}

Eigen::Vector3d FoundMarker::normal() const {
  return (corners[2] - corners[0]).cross(corners[1] - corners[3]).normalized();
}

double FoundMarker::side() const {
  double sum = 0.0;
  for (std::size_t k = 0; k < 4; ++k) sum += (corners[(k + 1) % 4] - corners[k]).norm();
  return 0.25 * sum;
}

MarkerMap find_markers(Sequence& sequence, const Reconstruction& reconstruction,
                       const std::vector<MarkerId>& wanted, const MarkerOptions& options) {
  if (wanted.empty()) return {};
  std::map<MarkerId, std::vector<View>> views;
  std::set<std::string> dictionaries;
  for (const MarkerId& marker : wanted) {
    views[marker];
    dictionaries.insert(marker.dictionary);
  }
  std::vector<const FrameRecord*> posed;
  for (const FrameRecord& frame : reconstruction.frames) {
    const bool in_range =
        frame.index >= sequence.first_frame() && frame.index < sequence.end_frame();
    if (frame.world_from_cam && in_range) posed.push_back(&frame);
  }
  const std::size_t count = std::min(posed.size(), static_cast<std::size_t>(options.most_frames));
  for (std::size_t i = 0; i < count; ++i) {
    const FrameRecord& frame = *posed[i * posed.size() / count];
    try {
      const cv::Mat grey = to_grey(sequence.read(frame.index).image);
      for (const std::string& dictionary : dictionaries) {
        look(grey, dictionary, reconstruction.camera, *frame.world_from_cam, views);
      }
    } catch (const UserError&) {
      continue;  // the render pass reports it
    }
  }
  MarkerMap markers;
  for (const auto& [marker, seen] : views) {
    if (seen.empty()) continue;
    if (const auto found = locate(reconstruction, seen, options)) markers[marker] = *found;
  }
  return markers;
}

}  // namespace planecast::engine
