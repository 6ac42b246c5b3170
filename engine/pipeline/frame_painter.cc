#include "engine/pipeline/frame_painter.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cstring>
#include <opencv2/imgproc.hpp>

#include "engine/channels.h"
#include "engine/convert.h"
#include "engine/look/camera_blur.h"
#include "engine/look/depth_edges.h"
#include "engine/look/object_layer.h"

namespace planecast::engine {
namespace {

constexpr double kNearShare = 0.02;  ///< near plane, of the median depth
constexpr double kFarShare = 100.0;  ///< far plane, of the median depth
/// Radius of shadows' edges in shares of a shadow map's side: rooms have no hard shadows.
constexpr float kShadowSoftness = 2.5F / 1024.0F;

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

/// A texel a pixel or more where the content is seen largest.
int shadow_map_size(const Reconstruction& reconstruction, const PlacedScene& placed, bool causal) {
  constexpr double kSmallest = 128.0;
  constexpr double kLargest = 1024.0;
  const slam::Camera& camera = reconstruction.camera;
  double extent_px = 0.0;
  for (const FrameRecord& frame : reconstruction.frames) {
    const auto& pose = causal ? frame.causal_world_from_cam : frame.world_from_cam;
    if (pose) extent_px = std::max(extent_px, placed.extent_px(frame.index, camera, *pose));
  }
  // The content hardly ever fills more than the picture's height.
  const double most = std::clamp(static_cast<double>(camera.height), kSmallest, kLargest);
  const double side = std::clamp(extent_px, kSmallest, most);
  return static_cast<int>(std::bit_ceil(static_cast<unsigned>(side)));
}

render::RendererOptions renderer_options(const PainterOptions& options, int shadow_map_size) {
  render::RendererOptions result;
  result.shadow_map_size = shadow_map_size;
  result.shader_dir = options.shader_dir.string();
  result.only_opengl = options.only_opengl;
  return result;
}

/// The camera whose lens the objects are drawn with.
slam::Camera drawing_camera(slam::Camera camera, bool lens) {
  if (!lens) camera.distortion.fill(0.0);
  return camera;
}

}  // namespace

FramePainter::FramePainter(const Reconstruction& reconstruction, const Content& content,
                           const LightTrack& light, const PainterOptions& options)
    : reconstruction_(reconstruction),
      options_(options),
      light_(light),
      warp_(drawing_camera(reconstruction.camera, options.look.lens)),
      grain_(options.seed) {
  set_content(content);
  scene_.light.sun.casts_shadow = options.placing.shadows;
  // Live, the map and what is known of the light change from frame to frame.
  scene_.still = !options.placing.causal;
}

void FramePainter::set_light(const SceneLight& light) {
  const auto sh = light.ambient_sh();
  std::ranges::transform(sh, scene_.light.ambient_sh.begin(),
                         [](const Eigen::Vector3d& c) { return to_glm(c); });
  scene_.light.sun.radiance = to_glm(light.sun_radiance);
  scene_.light.sun.direction_to_light = to_glm(light.sun_direction);
  scene_.light.environment = light_.environment();
  scene_.light.environment_gain = static_cast<float>(light.exposure);
}

void FramePainter::set_content(const Content& content) {
  placed_.emplace(reconstruction_, content, options_.placing);
  const int size = shadow_map_size(reconstruction_, *placed_, options_.placing.causal);
  if (size == shadow_map_size_) return;
  shadow_map_size_ = size;
  renderer_.emplace(renderer_options(options_, size));
  scene_.light.sun.softness = kShadowSoftness * static_cast<float>(size);
}

void FramePainter::set_depth(const slam::FrameInput& frame, const slam::Pose& world_from_cam) {
  const bool wanted = options_.placing.occlusion == Occlusion::kDepth ||
                      options_.placing.occlusion == Occlusion::kBoth;
  scene_.occluder_depth = nullptr;
  if (!wanted || frame.depth.empty()) return;
  cv::Mat filtered;
  if (options_.look.clean_edges) {
    filtered =
        refine_depth_edges(frame.depth, frame.image,
                           placed_->bounds(frame.index, reconstruction_.camera, world_from_cam));
  } else {
    // Single wild pixels of the sensor would pepper the object.
    cv::medianBlur(frame.depth, filtered, 5);
  }
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
  set_light(light_.at(frame.index));
  set_depth(frame, world_from_cam);
  placed_->at(frame.index, time_s, scene_);
  const double grain = options_.look.grain ? estimate_grain(grey) : 0.0;
  scene_.with_depth = grain >= kVisibleGrain;  // where grain goes
  render::Camera camera = to_render_camera(warp_.layer_camera(), world_from_cam.inverse());
  camera.near_plane = static_cast<float>(kNearShare * reconstruction_.median_depth);
  camera.far_plane = static_cast<float>(kFarShare * reconstruction_.median_depth);
  times_.look_ms = watch.lap_ms();

  render::Layer drawn = renderer_->draw_layer(scene_, camera);
  by_processor_ = drawn.by_processor;
  ObjectLayer layer = view_layer(drawn);
  times_.draw_ms = watch.lap_ms();
  times_.composite_ms = 0.0;
  if (layer.bounds.empty()) return false;

  if (options_.look.blur) apply_blur(estimate_blur(grey), layer);
  layer = warp_.to_raw(layer);
  grain_.apply(grain, frame.index, layer);
  composite(layer, picture);
  times_.composite_ms = watch.lap_ms();
  return true;
}

}  // namespace planecast::engine
