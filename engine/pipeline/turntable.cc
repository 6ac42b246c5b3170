#include "engine/pipeline/turntable.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/assets.h"
#include "engine/cancel.h"
#include "engine/convert.h"
#include "engine/look/object_layer.h"
#include "render/gltf/animate.h"
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

cv::Mat backdrop(int side) {
  cv::Mat picture(side, side, CV_8UC3);
  for (int y = 0; y < side; ++y) picture.row(y).setTo(cv::Scalar::all(190 - 50 * y / side));
  return picture;
}

/// A bright ceiling, a window to the left of the camera, a dim floor: uniform light would show
/// neither form nor gloss.
render::Light studio_light(const Eigen::Matrix3d& world_from_cam) {
  const Eigen::Vector3d sun = (world_from_cam * Eigen::Vector3d(-0.5, -0.9, -0.5)).normalized();
  render::Light light = render::Light::uniform(glm::vec3(0.5F), {to_glm(sun), glm::vec3(0.7F)});
  const Eigen::Vector3d window = world_from_cam * Eigen::Vector3d(-0.25, 0.0, -0.1);
  // Bands of the first order are y, z, x.
  light.ambient_sh[1] = glm::vec3(static_cast<float>(0.45 + window.y()));
  light.ambient_sh[2] = glm::vec3(static_cast<float>(window.z()));
  light.ambient_sh[3] = glm::vec3(static_cast<float>(window.x()));
  return light;
}

/// The map stands upright, its middle column behind the model as seen from the front.
void light_by(const EnvironmentLight& given, render::LayerScene& scene) {
  scene.light.ambient_sh = given.environment->harmonics(glm::mat3(1.0F));
  scene.light.environment = given.environment;
  scene.light.sun = given.sun;
  scene.exposure = given.exposure;
  scene.tone_map = render::ToneMap::kNeutral;
}

struct View {
  slam::Camera camera;
  slam::Pose world_from_cam = slam::Pose::Identity();
  double near_m = 0.01;
  double far_m = 100.0;
};

/// What the views share: where the model is and how large.
struct Stage {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius = 1.0;
  double floor_y = 0.0;
};

/// Of the rest pose, or of all that the animation reaches, so that the pictures of its moments fit
/// together.
Stage stage_of(const render::Model& model, const TurntableOptions& options) {
  const auto bounds_at = [&](double time_s) {
    return render::pose_bounds(
        model, render::evaluate_pose(model, options.animation, static_cast<float>(time_s)));
  };
  render::Box box = bounds_at(options.time_s);
  constexpr int kMoments = 16;
  const double duration_s = double{render::animation_duration_s(model, options.animation)};
  for (int i = 0; i <= kMoments && duration_s > 0.0; ++i) {
    const render::Box moment = bounds_at(duration_s * i / kMoments);
    box.min = glm::min(box.min, moment.min);
    box.max = glm::max(box.max, moment.max);
  }
  const Eigen::Vector3d low(box.min.x, box.min.y, box.min.z);
  const Eigen::Vector3d high(box.max.x, box.max.y, box.max.z);
  return {0.5 * (low + high), std::max(0.5 * (high - low).norm(), 1e-6), low.y()};
}

slam::Camera square_camera(int side, double focal) {
  slam::Camera camera;
  camera.width = camera.height = side;
  camera.fx = camera.fy = focal;
  camera.cx = camera.cy = 0.5 * (side - 1);
  return camera;
}

View turned_view(const Stage& stage, const TurntableOptions& options, int number) {
  const double elevation = options.elevation_deg * std::numbers::pi / 180.0;
  const double azimuth = options.azimuth_deg * std::numbers::pi / 180.0 +
                         2.0 * std::numbers::pi * number / options.views;
  const Eigen::Vector3d towards(std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
                                std::cos(elevation) * std::cos(azimuth));
  const double distance = 2.4 * stage.radius * kFocalShare;
  View view;
  view.camera = square_camera(options.view_size_px, kFocalShare * options.view_size_px);
  view.world_from_cam = look_at(stage.centre + distance * towards, stage.centre);
  view.near_m = 0.1 * (distance - stage.radius);
  view.far_m = 4.0 * distance;
  return view;
}

/// Through one of the model's cameras. An orthographic one is drawn from so far that its rays
/// differ by less than a pixel over the model.
View own_view(const Stage& stage, const render::Model& model, const TurntableOptions& options) {
  const render::ModelCamera& own = model.cameras[static_cast<std::size_t>(options.camera)];
  const render::ModelPose pose =
      render::evaluate_pose(model, options.animation, static_cast<float>(options.time_s));
  Eigen::Matrix4d world_from_node;
  const glm::mat4& node = pose.model_from_node[static_cast<std::size_t>(own.node)];
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) {
      world_from_node(row, column) = static_cast<double>(node[column][row]);
    }
  }
  View view;
  Eigen::Matrix3d axes = world_from_node.topLeftCorner<3, 3>();
  for (int i = 0; i < 3; ++i) axes.col(i).normalize();
  view.world_from_cam.linear() << axes.col(0), -axes.col(1), -axes.col(2);
  view.world_from_cam.translation() = world_from_node.col(3).head<3>();
  const double side = options.view_size_px;
  if (own.perspective) {
    view.camera =
        square_camera(options.view_size_px, 0.5 * side / std::tan(0.5 * double{own.y_fov_rad}));
  } else {
    constexpr double kFar = 200.0;
    const double back = kFar * std::max(stage.radius, double{own.half_height});
    view.world_from_cam.translation() += back * axes.col(2);
    view.camera = square_camera(options.view_size_px, 0.5 * side / double{own.half_height} * back);
  }
  const double away = (stage.centre - view.world_from_cam.translation()).norm();
  view.near_m = std::max(0.001 * stage.radius, 0.5 * (away - 2.0 * stage.radius));
  view.far_m = 2.0 * (away + 4.0 * stage.radius);
  return view;
}

}  // namespace

bool has_camera(const render::Model& model, int camera) {
  return camera >= 0 && static_cast<std::size_t>(camera) < model.cameras.size();
}

cv::Mat draw_turntable(const std::shared_ptr<const render::Model>& model,
                       const TurntableOptions& options) {
  const Stage stage = stage_of(*model, options);
  render::LayerScene scene;
  render::Instance instance;
  instance.model = model;
  instance.animation = options.animation;
  instance.animation_time_s = static_cast<float>(options.time_s);
  scene.instances.push_back(instance);
  scene.catchers.push_back(
      ground({stage.centre.x(), stage.floor_y, stage.centre.z()}, 2.0 * stage.radius));
  render::RendererOptions renderer_options;
  renderer_options.shader_dir = asset("shaders").string();
  if (!options.simplify) renderer_options.simplify_px = 0.0F;
  render::Renderer renderer(renderer_options);

  const bool own = has_camera(*model, options.camera);
  const int views = own ? 1 : options.views;
  const int columns = std::min(views, kColumns);
  const int rows = (views + columns - 1) / columns;
  const int side = options.view_size_px;
  cv::Mat sheet(rows * side, columns * side, CV_8UC3, cv::Scalar(255, 255, 255));
  for (int number = 0; number < views; ++number) {
    throw_if_cancelled();
    const View view = own ? own_view(stage, *model, options) : turned_view(stage, options, number);
    if (options.environment) {
      light_by(*options.environment, scene);
    } else {
      scene.light = studio_light(view.world_from_cam.linear());
    }
    render::Camera camera = to_render_camera(view.camera, view.world_from_cam.inverse());
    camera.near_plane = static_cast<float>(view.near_m);
    camera.far_plane = static_cast<float>(view.far_m);
    render::Layer layer = renderer.draw_layer(scene, camera);
    cv::Mat picture = backdrop(side);
    composite(view_layer(layer), picture);
    picture.copyTo(
        sheet(cv::Rect((number % columns) * side, (number / columns) * side, side, side)));
  }
  return sheet;
}

}  // namespace planecast::engine
