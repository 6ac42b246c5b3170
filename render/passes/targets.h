#pragma once

#include "render/gl/objects.h"
#include "render/scene.h"

namespace planecast::render {

/// The part of a picture that is drawn. Targets hold no more than that: a software rasteriser pays
/// for every pixel it clears, resolves and reads.
struct Window {
  int picture_width = 0;
  int picture_height = 0;
  Layer::Rect rect;  ///< in the picture; its corner is the target's first pixel
};

/// Whether a target of this size should be used for `rect`: large enough, not wastefully so.
bool fits(int width, int height, const Layer::Rect& rect);
/// Sides of a new target for `rect`: whole tiles of the rasteriser.
int whole_tiles(int side);

/// RGBA8 colour with depth and stencil, multisampled, and its resolved copy.
class ColorTarget {
 public:
  ColorTarget(const Gl& gl, int width, int height, int samples);

  /// Binds, clears to transparent and farthest, sets viewport and scissor for the window.
  void begin(const Window& window) const;
  /// Averages the samples of the window and reads them into their place of `out`, which has the
  /// picture's size (4 or 3 channels).
  void resolve(const Window& window, ImageU8& out) const;
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

  void begin(const Window& window) const;
  void read_depth(const Window& window, ImageF& out) const;
  void read_labels(const Window& window, Image<std::uint16_t>& out) const;
  int width() const { return width_; }
  int height() const { return height_; }

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
