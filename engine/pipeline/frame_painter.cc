#include "engine/pipeline/frame_painter.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <opencv2/imgproc.hpp>

#include "engine/convert.h"
#include "engine/look/camera_blur.h"
#include "engine/look/exposure.h"
#include "engine/look/object_layer.h"
#include "engine/scene/patches.h"

namespace planecast::engine {
namespace {

constexpr double kNearShare = 0.02;      ///< near plane, of the median depth
constexpr double kFarShare = 100.0;      ///< far plane, of the median depth
constexpr float kShadowSoftness = 2.5F;  ///< shadow-map texels: rooms have no hard shadows

class StopWatch {
 public:
  double lap_ms() {
    const auto now = std::chrono::steady_clock::now();
    const double ms = std::chrono::duration<double, std::milli>(now - start_).count();
    start_ = now;
    return ms;
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

cv::Mat to_grey(const cv::Mat& image) {
  if (image.channels() == 1) return image;
  cv::Mat grey;
  cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  return grey;
}

render::RendererOptions renderer_options(const PainterOptions& options) {
  render::RendererOptions result;
  result.shader_dir = options.shader_dir.string();
  return result;
}

render::Instance to_instance(const ContentItem& item, const Eigen::Affine3d& world_from_model) {
  render::Instance instance;
  instance.model = item.model;
  instance.world_from_model = to_glm(world_from_model.matrix());
  instance.animation = item.animation;
  return instance;
}

}  // namespace

cv::Mat to_bgr(const cv::Mat& image) {
  if (image.channels() == 3) return image.clone();
  cv::Mat bgr;
  cv::cvtColor(image, bgr, cv::COLOR_GRAY2BGR);
  return bgr;
}

FramePainter::FramePainter(const Reconstruction& reconstruction, const Content& content,
                           const SceneLight& light, const PainterOptions& options)
    : reconstruction_(reconstruction),
      options_(options),
      light_(light),
      warp_(reconstruction.camera),
      grain_(options.seed),
      renderer_(renderer_options(options)) {
  set_content(content);
  scene_.light.sun.casts_shadow = options.shadows;
  scene_.light.sun.softness = kShadowSoftness;
  scene_.light.sun.direction_to_light = to_glm(light.sun_direction);
}

void FramePainter::set_content(const Content& content) {
  scene_.instances.clear();
  scene_.catchers.clear();
  scene_.occluders.clear();
  for (const ContentItem& item : content.items) {
    if (const auto world_from_model = item.placed.world_from_model(reconstruction_.planes)) {
      scene_.instances.push_back(to_instance(item, *world_from_model));
    }
  }
  if (options_.shadows) scene_.catchers = shadow_catchers(reconstruction_, content);
  if (options_.occlusion == Occlusion::kPlanes || options_.occlusion == Occlusion::kBoth) {
    scene_.occluders = plane_occluders(reconstruction_, content);
  }
}

void FramePainter::set_light(double gain) {
  const auto sh = light_.ambient_sh(gain);
  std::ranges::transform(sh, scene_.light.ambient_sh.begin(),
                         [](const Eigen::Vector3d& c) { return to_glm(c); });
  scene_.light.sun.radiance = to_glm(Eigen::Vector3d(gain * light_.sun_radiance));
}

void FramePainter::set_depth(const cv::Mat& raw_depth) {
  const bool wanted =
      options_.occlusion == Occlusion::kDepth || options_.occlusion == Occlusion::kBoth;
  scene_.occluder_depth = nullptr;
  if (!wanted || raw_depth.empty()) return;
  // Single wild pixels of the sensor would pepper the object.
  cv::Mat filtered;
  cv::medianBlur(raw_depth, filtered, 5);
  const cv::Mat depth = warp_.depth_to_layer(filtered);
  depth_ = render::ImageF(depth.cols, depth.rows, 1);
  for (int y = 0; y < depth.rows; ++y) {
    std::memcpy(
        depth_.pixels.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(depth.cols),
        depth.ptr<float>(y), static_cast<std::size_t>(depth.cols) * sizeof(float));
  }
  scene_.occluder_depth = &depth_;
}

bool FramePainter::paint(const slam::FrameInput& frame, const slam::Pose& world_from_cam,
                         double time_s, cv::Mat& picture) {
  StopWatch watch;
  const cv::Mat grey = to_grey(frame.image);
  set_light(options_.follow_exposure ? exposure_gain(reconstruction_, frame.image, world_from_cam)
                                     : 1.0);
  set_depth(frame.depth);
  for (render::Instance& instance : scene_.instances) {
    instance.animation_time_s = static_cast<float>(time_s);
  }
  render::Camera camera = to_render_camera(warp_.layer_camera(), world_from_cam.inverse());
  camera.near_plane = static_cast<float>(kNearShare * reconstruction_.median_depth);
  camera.far_plane = static_cast<float>(kFarShare * reconstruction_.median_depth);
  times_.look_ms = watch.lap_ms();

  render::Layer drawn = renderer_.draw_layer(scene_, camera);
  ObjectLayer layer = view_layer(drawn);
  times_.draw_ms = watch.lap_ms();
  times_.composite_ms = 0.0;
  if (layer.bounds.empty()) return false;

  if (options_.match_blur) apply_blur(estimate_blur(grey), layer);
  layer = warp_.to_raw(layer);
  if (options_.match_grain) grain_.apply(estimate_grain(grey), frame.index, layer);
  composite(layer, picture);
  times_.composite_ms = watch.lap_ms();
  return true;
}

}  // namespace planecast::engine
