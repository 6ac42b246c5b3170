#pragma once

#include "render/gl/objects.h"
#include "render/scene.h"

namespace planecast::render {

/// RGBA8 colour with depth and stencil, multisampled, and its resolved copy.
class ColorTarget {
 public:
  ColorTarget(const Gl& gl, int width, int height, int samples);

  /// Binds, sets viewport and scissor to `rect`, clears to transparent and farthest.
  void begin(const Layer::Rect& rect) const;
  /// Averages the samples of `rect` and reads it into the same place of `out` (4 or 3 channels).
  void resolve(const Layer::Rect& rect, ImageU8& out) const;
  int width() const { return width_; }
  int height() const { return height_; }

 private:
  const Gl* gl_;
  int width_;
  int height_;
  int samples_;
  RenderbufferHandle color_;
  RenderbufferHandle depth_;
  FramebufferHandle framebuffer_;
  RenderbufferHandle resolved_color_;
  FramebufferHandle resolved_;
};

/// Depth in metres (R32F) and label (R16UI) at pixel centres, one sample.
class GeometryTarget {
 public:
  GeometryTarget(const Gl& gl, int width, int height);

  void begin(const Layer::Rect& rect) const;
  void read_depth(const Layer::Rect& rect, ImageF& out) const;
  void read_labels(const Layer::Rect& rect, Image<std::uint16_t>& out) const;

 private:
  const Gl* gl_;
  int width_;
  int height_;
  TextureHandle depth_m_;
  TextureHandle labels_;
  RenderbufferHandle depth_;
  FramebufferHandle framebuffer_;
};

}  // namespace planecast::render
