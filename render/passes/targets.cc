#include "render/passes/targets.h"

#include <array>

namespace planecast::render {
namespace {

constexpr GLenum kDepthFormat = GL_DEPTH32F_STENCIL8;

/// The picture lies under the target so that the window's corner comes to its first pixel.
void set_window(const Gl& gl, const Window& window) {
  gl.Viewport(-window.rect.x, -window.rect.y, window.picture_width, window.picture_height);
  gl.Enable(GL_SCISSOR_TEST);
  gl.Scissor(0, 0, window.rect.width, window.rect.height);
}

template <typename T>
void read_rect(const Gl& gl, const Layer::Rect& rect, GLenum format, GLenum type, Image<T>& out) {
  gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
  gl.PixelStorei(GL_PACK_ROW_LENGTH, out.width);
  const std::size_t first =
      (static_cast<std::size_t>(rect.y) * static_cast<std::size_t>(out.width) +
       static_cast<std::size_t>(rect.x)) *
      static_cast<std::size_t>(out.channels);
  gl.ReadPixels(0, 0, rect.width, rect.height, format, type, out.pixels.data() + first);
}

}  // namespace

bool fits(int width, int height, const Layer::Rect& rect) {
  constexpr int kMostWaste = 2;
  const int needed = whole_tiles(rect.width) * whole_tiles(rect.height);
  return width >= rect.width && height >= rect.height && width * height <= kMostWaste * needed;
}

int whole_tiles(int side) {
  constexpr int kTile = 64;  // of llvmpipe
  return (side + kTile - 1) / kTile * kTile;
}

ColorTarget::ColorTarget(const Gl& gl, int width, int height, int samples)
    : gl_(&gl),
      width_(width),
      height_(height),
      samples_(samples),
      color_(make_renderbuffer(gl, GL_RGBA8, samples, width, height)),
      depth_(make_renderbuffer(gl, kDepthFormat, samples, width, height)),
      framebuffer_(gl) {
  gl.NamedFramebufferRenderbuffer(framebuffer_.id(), GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER,
                                  color_.id());
  gl.NamedFramebufferRenderbuffer(framebuffer_.id(), GL_DEPTH_STENCIL_ATTACHMENT, GL_RENDERBUFFER,
                                  depth_.id());
  check_complete(gl, framebuffer_, "colour");
  if (samples_ > 1) {
    resolved_color_ = make_renderbuffer(gl, GL_RGBA8, 1, width, height);
    resolved_ = FramebufferHandle(gl);
    gl.NamedFramebufferRenderbuffer(resolved_.id(), GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER,
                                    resolved_color_.id());
    check_complete(gl, resolved_, "the resolved colour");
  }
}

void ColorTarget::begin(const Window& window) const {
  gl_->BindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
  gl_->Disable(GL_SCISSOR_TEST);
  gl_->ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  gl_->DepthMask(GL_TRUE);
  const std::array<float, 4> transparent{};
  gl_->ClearNamedFramebufferfv(framebuffer_.id(), GL_COLOR, 0, transparent.data());
  gl_->ClearNamedFramebufferfi(framebuffer_.id(), GL_DEPTH_STENCIL, 0, 0.0F, 0);
  set_window(*gl_, window);
}

void ColorTarget::resolve(const Window& window, ImageU8& out) const {
  const Layer::Rect& rect = window.rect;
  const FramebufferHandle& source = samples_ > 1 ? resolved_ : framebuffer_;
  if (samples_ > 1) {
    gl_->BlitNamedFramebuffer(framebuffer_.id(), resolved_.id(), 0, 0, rect.width, rect.height, 0,
                              0, rect.width, rect.height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  }
  gl_->BindFramebuffer(GL_FRAMEBUFFER, source.id());
  read_rect(*gl_, rect, out.channels == 4 ? GL_RGBA : GL_RGB, GL_UNSIGNED_BYTE, out);
}

GeometryTarget::GeometryTarget(const Gl& gl, int width, int height)
    : gl_(&gl),
      width_(width),
      height_(height),
      depth_m_(make_target(gl, GL_R32F, width, height)),
      labels_(make_target(gl, GL_R16UI, width, height)),
      depth_(make_renderbuffer(gl, kDepthFormat, 1, width, height)),
      framebuffer_(gl) {
  gl.NamedFramebufferTexture(framebuffer_.id(), GL_COLOR_ATTACHMENT0, depth_m_.id(), 0);
  gl.NamedFramebufferTexture(framebuffer_.id(), GL_COLOR_ATTACHMENT1, labels_.id(), 0);
  gl.NamedFramebufferRenderbuffer(framebuffer_.id(), GL_DEPTH_STENCIL_ATTACHMENT, GL_RENDERBUFFER,
                                  depth_.id());
  const std::array<GLenum, 2> buffers = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
  gl.NamedFramebufferDrawBuffers(framebuffer_.id(), 2, buffers.data());
  check_complete(gl, framebuffer_, "depth and labels");
}

void GeometryTarget::begin(const Window& window) const {
  gl_->BindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
  gl_->Disable(GL_SCISSOR_TEST);
  gl_->ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  gl_->DepthMask(GL_TRUE);
  const std::array<float, 4> zero{};
  const std::array<GLuint, 4> none{};
  gl_->ClearNamedFramebufferfv(framebuffer_.id(), GL_COLOR, 0, zero.data());
  gl_->ClearNamedFramebufferuiv(framebuffer_.id(), GL_COLOR, 1, none.data());
  gl_->ClearNamedFramebufferfi(framebuffer_.id(), GL_DEPTH_STENCIL, 0, 0.0F, 0);
  set_window(*gl_, window);
}

void GeometryTarget::read_depth(const Window& window, ImageF& out) const {
  gl_->BindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
  gl_->NamedFramebufferReadBuffer(framebuffer_.id(), GL_COLOR_ATTACHMENT0);
  read_rect(*gl_, window.rect, GL_RED, GL_FLOAT, out);
}

void GeometryTarget::read_labels(const Window& window, Image<std::uint16_t>& out) const {
  gl_->BindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
  gl_->NamedFramebufferReadBuffer(framebuffer_.id(), GL_COLOR_ATTACHMENT1);
  read_rect(*gl_, window.rect, GL_RED_INTEGER, GL_UNSIGNED_SHORT, out);
}

}  // namespace planecast::render
