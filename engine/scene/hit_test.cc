#include "engine/scene/hit_test.h"

#include <cstdio>
#include <cstdlib>
#include <set>

#include "engine/scene/plane_motion.h"
#include "engine/scene/plane_outline.h"
#include "engine/user_error.h"

namespace planecast::engine {
namespace {

/// Rays along the plane within about half a degree meet it nowhere in particular.
constexpr double kMinIncidence = 0.01;

/// Where the ray passes through the plane from its front.
std::optional<Hit> cross(const PlaneRecord& plane, const Ray& ray) {
  const double slope = plane.normal.dot(ray.direction);
  if (slope > -kMinIncidence * ray.direction.norm()) return std::nullopt;
  const double depth = -(plane.normal.dot(ray.origin) + plane.offset) / slope;
  if (depth <= 0.0) return std::nullopt;
  return Hit{plane.id, ray.origin + depth * ray.direction, depth};
}

std::string describe_pixel(int frame, const Eigen::Vector2d& pixel) {
  char text[96];
  std::snprintf(text, sizeof(text), "pixel (%g, %g) of frame %d", pixel.x(), pixel.y(), frame);
  return text;
}

/// The planes that a grid of rays through the picture meets.
std::vector<PlaneRecord> planes_in_view(const std::vector<PlaneRecord>& planes,
                                        const slam::Camera& camera,
                                        const slam::Pose& world_from_cam) {
  constexpr int kRays = 16;  // a side
  std::set<int> ids;
  for (int i = 0; i < kRays * kRays; ++i) {
    const Eigen::Vector2d pixel((i % kRays + 0.5) * camera.width / kRays,
                                (i / kRays + 0.5) * camera.height / kRays);
    const auto hit = hit_test(planes, pixel_ray(camera, world_from_cam, pixel), {0.0});
    if (hit) ids.insert(hit->plane_id);
  }
  std::vector<PlaneRecord> seen;
  for (const PlaneRecord& plane : planes) {
    if (ids.count(plane.id) != 0) seen.push_back(plane);
  }
  return seen;
}

}  // namespace

Ray pixel_ray(const slam::Camera& camera, const slam::Pose& world_from_cam,
              const Eigen::Vector2d& raw_pixel) {
  return {world_from_cam.translation(),
          world_from_cam.linear() * camera.ray(camera.undistort(raw_pixel))};
}

std::vector<PlaneRecord> planes_at(const Reconstruction& reconstruction, int frame, bool causal) {
  return causal ? planes_as_known(reconstruction, frame) : reconstruction.planes;
}

std::optional<Hit> hit_test(const std::vector<PlaneRecord>& planes, const Ray& ray,
                            const HitOptions& options) {
  std::optional<Hit> inside;
  std::optional<Hit> beside;
  double least_share = options.dilation;
  for (const PlaneRecord& plane : planes) {
    const std::optional<Hit> hit = cross(plane, ray);
    if (!hit) continue;
    const PlaneOutline outline = plane_outline(plane);
    const Eigen::Vector2d point = (plane.world_from_plane().inverse() * hit->point).head<2>();
    if (contains(outline, point)) {
      if (!inside || hit->depth < inside->depth) inside = hit;
    } else if (outline.outer.size() >= 3) {
      const double share = distance_to_edge(outline, point) / hit->depth;
      if (share > least_share) continue;
      least_share = share;
      beside = hit;
    }
  }
  return inside ? inside : beside;
}

slam::Pose frame_pose(const Reconstruction& reconstruction, int frame, bool causal,
                      const std::string& where) {
  const std::string name = where + ": frame " + std::to_string(frame);
  const FrameRecord* record = nullptr;
  for (const FrameRecord& candidate : reconstruction.frames) {
    if (candidate.index == frame) record = &candidate;
  }
  if (record == nullptr) {
    const std::string range = reconstruction.frames.empty()
                                  ? "none"
                                  : std::to_string(reconstruction.frames.front().index) + " to " +
                                        std::to_string(reconstruction.frames.back().index);
    throw UserError(name + " is not there (frames: " + range + ")");
  }
  const auto& pose = causal ? record->causal_world_from_cam : record->world_from_cam;
  if (pose) return *pose;
  int nearest = -1;
  for (const FrameRecord& other : reconstruction.frames) {
    if (!(causal ? other.causal_world_from_cam : other.world_from_cam)) continue;
    if (nearest < 0 || std::abs(other.index - frame) < std::abs(nearest - frame))
      nearest = other.index;
  }
  throw UserError(name + " has no camera pose (" + record->state +
                  (record->reason.empty() ? "" : ": " + record->reason) + "); " +
                  (nearest < 0 ? "no frame has one"
                               : "the nearest frame with one is " + std::to_string(nearest)));
}

Hit tap(const Reconstruction& reconstruction, int frame, const Eigen::Vector2d& raw_pixel,
        bool causal, const std::string& where) {
  const slam::Pose world_from_cam = frame_pose(reconstruction, frame, causal, where);
  const slam::Camera& camera = reconstruction.camera;
  if (!camera.contains(raw_pixel)) {
    throw UserError(where + ": " + describe_pixel(frame, raw_pixel) +
                    " lies outside the picture (" + std::to_string(camera.width) + "x" +
                    std::to_string(camera.height) + ")");
  }
  const Ray ray = pixel_ray(camera, world_from_cam, raw_pixel);
  const std::vector<PlaneRecord> planes = planes_at(reconstruction, frame, causal);
  if (const std::optional<Hit> hit = hit_test(planes, ray)) return *hit;
  throw UserError(
      where + ": there is no plane at " + describe_pixel(frame, raw_pixel) +
      "; planes in that frame: " + list_planes(planes_in_view(planes, camera, world_from_cam)));
}

}  // namespace planecast::engine
