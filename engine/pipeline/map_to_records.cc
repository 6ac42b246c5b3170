#include "engine/pipeline/map_to_records.h"

#include <algorithm>

#include "slam/geometry/plane_geometry.h"

namespace planecast::engine {
namespace {

double median_of_landmark_depths(const slam::Map& map) {
  std::vector<double> depths;
  for (const slam::Keyframe& keyframe : map.keyframes) {
    depths.push_back(map.median_depth(keyframe.id));
  }
  if (depths.empty()) return 1.0;
  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  return *middle;
}

PlaneRecord record_of(const slam::Map& map, const slam::Plane& plane, double spacing) {
  PlaneRecord record;
  record.id = plane.id;
  record.normal = plane.normal;
  record.offset = plane.offset;
  record.origin = plane.origin;
  record.x_axis = plane.x_axis;
  record.inliers = plane.inliers;
  record.rms = plane.rms;
  record.label = plane.label;
  record.first_frame = plane.first_frame;
  record.merged_from = plane.merged_from;
  std::vector<Eigen::Vector3d> support;
  for (const slam::LandmarkId id : map.landmarks_of(plane.id)) {
    support.push_back(map.landmarks.at(id).position);
  }
  support.insert(support.end(), plane.depth_points.begin(), plane.depth_points.end());
  const slam::PlaneExtent extent = slam::plane_extent(plane, support, spacing);
  record.polygon = extent.outer;
  record.holes = extent.holes;
  record.area = extent.area;
  return record;
}

}  // namespace

Reconstruction map_to_records(const slam::Map& map, const slam::Camera& camera, bool metric,
                              slam::KeyframeId first_keyframe) {
  Reconstruction result;
  result.camera = camera;
  result.metric = metric;
  result.median_depth = median_of_landmark_depths(map);
  for (const slam::Keyframe& keyframe : map.keyframes) {
    if (keyframe.id < first_keyframe) continue;
    result.keyframes.push_back(
        {keyframe.frame_index, keyframe.timestamp, keyframe.cam_from_world.inverse()});
  }
  // Landmarks lie about this far apart where a surface has texture; the extent bridges no wider
  // gaps.
  const double spacing = 0.05 * result.median_depth;
  for (const slam::Plane& plane : map.planes) {
    if (!plane.weak) result.planes.push_back(record_of(map, plane, spacing));
  }
  for (const slam::Landmark& landmark : map.landmarks) {
    const slam::Plane* plane = map.planes.find(landmark.plane);
    result.points.push_back({landmark.position, landmark.color,
                             plane != nullptr && !plane->weak ? landmark.plane : slam::kNone});
  }
  return result;
}

}  // namespace planecast::engine
