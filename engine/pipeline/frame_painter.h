#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "engine/look/grain.h"
#include "engine/look/lens_warp.h"
#include "engine/pipeline/reconstruction.h"
#include "engine/pipeline/scene_light.h"
#include "engine/scene/content.h"
#include "engine/scene/placed_scene.h"
#include "render/renderer.h"
#include "slam/data/frame.h"

namespace planecast::engine {

struct PainterOptions {
  std::filesystem::path shader_dir;
  PlacedSceneOptions placing;
  Look look;
  bool only_opengl = false;  ///< see render::RendererOptions
  std::uint64_t seed = 1;
};

/// Milliseconds of one painted frame.
struct PaintTimes {
  double look_ms = 0.0;       ///< depth
  double draw_ms = 0.0;       ///< the renderer
  double composite_ms = 0.0;  ///< blur, grain, lens and compositing
};

/// Draws the content into pictures: layer by the renderer, then everything that makes it belong to
/// the picture. Each picture depends on its own frame alone, so that any of them can be made again.
/// All that it was made with must outlive it; the renderer inside belongs to the thread that made
/// the painter.
class FramePainter {
 public:
  /// Throws std::runtime_error when no rendering context can be made.
  FramePainter(const Reconstruction& reconstruction, const Content& content,
               const LightTrack& light, const PainterOptions& options);

  /// Draws other content from now on. Models that stay are kept, unless the content is now seen so
  /// much larger or smaller that its shadows need another map.
  void set_content(const Content& content);

  /// Returns whether anything was drawn. `frame.image` stays as it is; `picture` is CV_8UC3 BGR and
  /// holds the frame's picture. `time_s` runs the animations.
  bool paint(const slam::FrameInput& frame, const slam::Pose& world_from_cam, double time_s,
             cv::Mat& picture);
  const PaintTimes& times() const { return times_; }
  /// Whether the last layer was drawn without OpenGL.
  bool by_processor() const { return by_processor_; }
  std::string renderer_description() const { return renderer_->description(); }

 private:
  void set_light(const SceneLight& light);
  void set_depth(const slam::FrameInput& frame, const slam::Pose& world_from_cam);

  const Reconstruction& reconstruction_;
  PainterOptions options_;
  const LightTrack& light_;
  LensWarp warp_;
  Grain grain_;
  std::optional<PlacedScene> placed_;
  int shadow_map_size_ = 0;
  std::optional<render::Renderer> renderer_;  ///< made for shadow_map_size_
  render::LayerScene scene_;
  render::ImageF depth_;
  PaintTimes times_;
  bool by_processor_ = false;
};

}  // namespace planecast::engine
