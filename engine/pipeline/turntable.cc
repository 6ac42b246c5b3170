#include "engine/pipeline/turntable.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/assets.h"
#include "engine/convert.h"
#include "engine/look/object_layer.h"
#include "render/gltf/import.h"
#include "render/renderer.h"

namespace planecast::engine {
namespace {

constexpr double kFocalShare = 1.6;  ///< focal length over the view's side: about 35 degrees
constexpr int kColumns = 4;

/// World from camera of a camera (x right, y down, z forward) that looks at `target`, y up in the
/// world.
slam::Pose look_at(const Eigen::Vector3d& position, const Eigen::Vector3d& target) {
  const Eigen::Vector3d forward = (target - position).normalized();
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitY()).normalized();
  slam::Pose pose = slam::Pose::Identity();
  pose.linear() << right, forward.cross(right), forward;
  pose.translation() = position;
  return pose;
}

render::PlanePatch ground(const Eigen::Vector3d& centre, double radius) {
  render::PlanePatch patch;
  patch.normal = {0.0F, 1.0F, 0.0F};
  constexpr int kCorners = 24;
  for (int i = 0; i < kCorners; ++i) {
    const double angle = -2.0 * std::numbers::pi * i / kCorners;
    patch.outer.push_back(to_glm(
        Eigen::Vector3d(centre + radius * Eigen::Vector3d(std::cos(angle), 0.0, std::sin(angle)))));
  }
  patch.edge_softness_m = static_cast<float>(0.4 * radius);
  return patch;
}

cv::Mat light_backdrop(int side) {
  cv::Mat backdrop(side, side, CV_8UC3);
  for (int y = 0; y < side; ++y) backdrop.row(y).setTo(cv::Scalar::all(232 - 40 * y / side));
  return backdrop;
}

}  // namespace

cv::Mat draw_turntable(const std::shared_ptr<const render::Model>& model,
                       const TurntableOptions& options) {
  const render::Bounds bounds = render::model_bounds(*model);
  const Eigen::Vector3d low(bounds.min.x, bounds.min.y, bounds.min.z);
  const Eigen::Vector3d high(bounds.max.x, bounds.max.y, bounds.max.z);
  const Eigen::Vector3d centre = 0.5 * (low + high);
  const double radius = std::max(0.5 * (high - low).norm(), 1e-6);
  const double distance = 2.4 * radius * kFocalShare;

  render::LayerScene scene;
  render::Instance instance;
  instance.model = model;
  instance.animation = options.animation;
  instance.animation_time_s = static_cast<float>(options.time_s);
  scene.instances.push_back(instance);
  scene.catchers.push_back(ground({centre.x(), low.y(), centre.z()}, 2.0 * radius));

  slam::Camera camera;
  camera.width = camera.height = options.view_size_px;
  camera.fx = camera.fy = kFocalShare * options.view_size_px;
  camera.cx = camera.cy = 0.5 * (options.view_size_px - 1);
  render::RendererOptions renderer_options;
  renderer_options.shader_dir = asset("shaders").string();
  render::Renderer renderer(renderer_options);

  const int columns = std::min(options.views, kColumns);
  const int rows = (options.views + columns - 1) / columns;
  cv::Mat sheet(rows * options.view_size_px, columns * options.view_size_px, CV_8UC3,
                cv::Scalar(255, 255, 255));
  const double elevation = options.elevation_deg * std::numbers::pi / 180.0;
  for (int view = 0; view < options.views; ++view) {
    const double azimuth = 2.0 * std::numbers::pi * view / options.views;
    const Eigen::Vector3d towards(std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
                                  std::cos(elevation) * std::cos(azimuth));
    const slam::Pose world_from_cam = look_at(centre + distance * towards, centre);
    const Eigen::Vector3d sun =
        (world_from_cam.linear() * Eigen::Vector3d(-0.5, -0.9, -0.5)).normalized();
    scene.light = render::Light::uniform(glm::vec3(0.55F), {to_glm(sun), glm::vec3(0.6F)});
    render::Camera render_camera = to_render_camera(camera, world_from_cam.inverse());
    render_camera.near_plane = static_cast<float>(0.1 * (distance - radius));
    render_camera.far_plane = static_cast<float>(4.0 * distance);
    render::Layer layer = renderer.draw_layer(scene, render_camera);
    cv::Mat picture = light_backdrop(options.view_size_px);
    composite(view_layer(layer), picture);
    picture.copyTo(sheet(cv::Rect((view % columns) * options.view_size_px,
                                  (view / columns) * options.view_size_px, options.view_size_px,
                                  options.view_size_px)));
  }
  return sheet;
}

}  // namespace planecast::engine
