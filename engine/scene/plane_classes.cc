#include "engine/scene/plane_classes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace planecast::engine {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// Mean axes of the cameras in the world, all poses counted alike.
struct MeanView {
  Eigen::Vector3d image_up = -Eigen::Vector3d::UnitY();
  Eigen::Vector3d backward = -Eigen::Vector3d::UnitZ();
  std::vector<Eigen::Matrix3d> world_from_level;  ///< columns: right, image up, backward; per frame
};

MeanView mean_view(const Reconstruction& reconstruction) {
  MeanView view;
  // With a negative fy the camera's y axis runs up in the picture.
  const double up_sign = reconstruction.camera.fy < 0.0 ? 1.0 : -1.0;
  Eigen::Vector3d up_sum = Eigen::Vector3d::Zero();
  Eigen::Vector3d back_sum = Eigen::Vector3d::Zero();
  for (const FrameRecord& frame : reconstruction.frames) {
    if (!frame.world_from_cam) continue;
    const Eigen::Matrix3d rotation = frame.world_from_cam->linear();
    Eigen::Matrix3d axes;
    axes << rotation.col(0), up_sign * rotation.col(1), -rotation.col(2);
    view.world_from_level.push_back(axes);
    up_sum += axes.col(1);
    back_sum += axes.col(2);
  }
  if (up_sum.norm() > 1e-6) view.image_up = up_sum.normalized();
  if (back_sum.norm() > 1e-6) view.backward = back_sum.normalized();
  return view;
}

/// How likely a person looks down by this angle: mostly between level and steep, seldom straight
/// down, hardly ever upwards.
double pitch_likelihood(double down_deg) {
  if (down_deg < -20.0) return std::max(0.02, 1.0 - (-20.0 - down_deg) / 25.0);
  if (down_deg > 60.0) return std::max(0.1, 1.0 - (down_deg - 60.0) / 30.0);
  return 1.0;
}

double camera_likelihood(const MeanView& view, const Eigen::Vector3d& up,
                         const UpOptions& options) {
  if (view.world_from_level.empty()) return 0.5;
  double sum = 0.0;
  for (const Eigen::Matrix3d& axes : view.world_from_level) {
    const Eigen::Vector3d local = axes.transpose() * up;
    const double roll_deg = std::asin(std::clamp(local.x(), -1.0, 1.0)) / kDegree;
    const double down_deg = std::atan2(local.z(), local.y()) / kDegree;
    const double roll = roll_deg / options.max_roll_deg;
    sum += std::exp(-0.5 * roll * roll) * pitch_likelihood(down_deg);
  }
  return sum / static_cast<double>(view.world_from_level.size());
}

/// Share of the planes' area that is parallel or at right angles to `up`.
double plane_support(const Reconstruction& reconstruction, const Eigen::Vector3d& up,
                     const UpOptions& options) {
  const double parallel = std::cos(options.same_direction_deg * kDegree);
  const double upright = std::sin(options.same_direction_deg * kDegree);
  double total = 0.0;
  double support = 0.0;
  for (const PlaneRecord& plane : reconstruction.planes) {
    const double cosine = std::abs(plane.normal.dot(up));
    total += plane.area;
    if (cosine > parallel || cosine < upright) support += plane.area;
  }
  return total > 0.0 ? support / total : 0.0;
}

/// Area-weighted mean of the normals within the family of `up`, signs aligned to it.
Eigen::Vector3d family_mean(const Reconstruction& reconstruction, const Eigen::Vector3d& up,
                            const UpOptions& options) {
  const double parallel = std::cos(options.same_direction_deg * kDegree);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const PlaneRecord& plane : reconstruction.planes) {
    const double cosine = plane.normal.dot(up);
    if (std::abs(cosine) > parallel) sum += std::copysign(plane.area, cosine) * plane.normal;
  }
  return sum.norm() > 0.0 ? Eigen::Vector3d(sum.normalized()) : up;
}

/// The cameras' idea of up, corrected by the planes that it makes nearly upright.
Eigen::Vector3d squared_to_walls(const Reconstruction& reconstruction, Eigen::Vector3d up,
                                 const UpOptions& options) {
  const double upright = std::sin(2.0 * options.same_direction_deg * kDegree);
  double total = 0.0;
  for (const PlaneRecord& plane : reconstruction.planes) total += plane.area;
  Eigen::Vector3d tilt = Eigen::Vector3d::Zero();
  for (const PlaneRecord& plane : reconstruction.planes) {
    const double cosine = plane.normal.dot(up);
    if (std::abs(cosine) < upright) tilt += plane.area / total * cosine * plane.normal;
  }
  return (up - tilt).normalized();
}

struct Proposal {
  Eigen::Vector3d up;
  double score = 0.0;
};

double median_camera_height(const Reconstruction& reconstruction) {
  std::vector<double> heights;
  for (const FrameRecord& frame : reconstruction.frames) {
    if (frame.world_from_cam) {
      heights.push_back(frame.world_from_cam->translation().dot(reconstruction.up));
    }
  }
  if (heights.empty()) return 0.0;
  const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
  std::nth_element(heights.begin(), middle, heights.end());
  return *middle;
}

double height_of(const Reconstruction& reconstruction, const PlaneRecord& plane) {
  if (plane.polygon.empty()) return plane.origin.dot(reconstruction.up);
  double sum = 0.0;
  for (const Eigen::Vector3d& corner : plane.polygon) sum += corner.dot(reconstruction.up);
  return sum / static_cast<double>(plane.polygon.size());
}

/// The lowest plane that faces up and is not small beside the largest such one.
PlaneRecord* lowest_large(Reconstruction& reconstruction) {
  constexpr double kNotSmall = 0.2;
  double largest_area = 0.0;
  for (const PlaneRecord& plane : reconstruction.planes) {
    if (plane.plane_class == "horizontal") largest_area = std::max(largest_area, plane.area);
  }
  PlaneRecord* lowest = nullptr;
  for (PlaneRecord& plane : reconstruction.planes) {
    if (plane.plane_class != "horizontal" || plane.area < kNotSmall * largest_area) continue;
    if (plane.normal.dot(reconstruction.up) < 0.0) continue;
    if (lowest == nullptr ||
        height_of(reconstruction, plane) < height_of(reconstruction, *lowest)) {
      lowest = &plane;
    }
  }
  return lowest;
}

bool is_floor(const Reconstruction& reconstruction, const PlaneRecord& lowest,
              const ClassOptions& options) {
  const double height = height_of(reconstruction, lowest);
  if (reconstruction.metric) {
    return median_camera_height(reconstruction) - height >= options.floor_below_camera_m;
  }
  // Without a scale only company tells a floor from a table: something else to put things on, above
  // it.
  constexpr double kClearlyAbove = 0.15;  // of the median depth
  return std::ranges::any_of(reconstruction.planes, [&](const PlaneRecord& plane) {
    return plane.plane_class == "horizontal" && plane.normal.dot(reconstruction.up) > 0.0 &&
           height_of(reconstruction, plane) > height + kClearlyAbove * reconstruction.median_depth;
  });
}

}  // namespace

UpEstimate estimate_up(const Reconstruction& reconstruction, const UpOptions& options) {
  if (options.known_up && options.known_up->norm() > 0.0)
    return {options.known_up->normalized(), 1.0};
  const MeanView view = mean_view(reconstruction);
  std::vector<Proposal> proposals;
  const auto propose = [&](const Eigen::Vector3d& up, double weight) {
    const double support = 0.3 + 0.7 * plane_support(reconstruction, up, options);
    proposals.push_back({up, weight * support * camera_likelihood(view, up, options)});
  };
  // A camera's own idea of up is rough: it says nothing of the pitch.
  constexpr double kCameraAlone = 0.6;
  propose(squared_to_walls(reconstruction, view.image_up, options), kCameraAlone);
  for (const PlaneRecord& plane : reconstruction.planes) {
    const bool down = plane.normal.dot(view.image_up + view.backward) < 0.0;
    propose(
        family_mean(reconstruction, down ? Eigen::Vector3d(-plane.normal) : plane.normal, options),
        1.0);
  }
  const auto by_score = [](const Proposal& a, const Proposal& b) { return a.score < b.score; };
  const Proposal best = *std::ranges::max_element(proposals, by_score);
  double rival = 0.0;
  for (const Proposal& other : proposals) {
    const bool same = other.up.dot(best.up) > std::cos(2.0 * options.same_direction_deg * kDegree);
    if (!same) rival = std::max(rival, other.score);
  }
  const double lead = best.score > 0.0 ? 1.0 - rival / best.score : 0.0;
  return {best.up, std::clamp(best.score * (0.5 + 0.5 * lead), 0.0, 0.99)};
}

void classify_planes(Reconstruction& reconstruction, const UpOptions& up_options,
                     const ClassOptions& class_options) {
  const UpEstimate estimate = estimate_up(reconstruction, up_options);
  reconstruction.up = estimate.up;
  reconstruction.up_confidence = estimate.confidence;
  const double level = std::cos(class_options.level_deg * kDegree);
  const double upright = std::sin(class_options.upright_deg * kDegree);
  const double camera_height = median_camera_height(reconstruction);
  double largest_upright = 0.0;
  for (PlaneRecord& plane : reconstruction.planes) {
    const double cosine = plane.normal.dot(reconstruction.up);
    plane.plane_class = "other";
    if (cosine > level) plane.plane_class = "horizontal";
    if (cosine < -level) {
      plane.plane_class =
          height_of(reconstruction, plane) > camera_height ? "ceiling" : "horizontal";
    }
    if (std::abs(cosine) < upright) {
      plane.plane_class = "vertical";
      largest_upright = std::max(largest_upright, plane.area);
    }
  }
  for (PlaneRecord& plane : reconstruction.planes) {
    const bool large = plane.area >= class_options.wall_area_share * largest_upright;
    if (plane.plane_class == "vertical" && large) plane.plane_class = "wall";
  }
  PlaneRecord* lowest = lowest_large(reconstruction);
  if (lowest == nullptr || !is_floor(reconstruction, *lowest, class_options)) return;
  const double floor_height = height_of(reconstruction, *lowest);
  // A floor may have come out in pieces; all at its height belong to it.
  constexpr double kSameHeight = 0.03;  // of the median depth
  for (PlaneRecord& plane : reconstruction.planes) {
    if (plane.plane_class == "horizontal" && plane.normal.dot(reconstruction.up) > 0.0 &&
        std::abs(height_of(reconstruction, plane) - floor_height) <
            kSameHeight * reconstruction.median_depth) {
      plane.plane_class = "floor";
    }
  }
}

}  // namespace planecast::engine
