#include "render/imgui/painter.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <stdexcept>

#include "render/context/context.h"
#include "render/gl/image_texture.h"
#include "render/gl/program.h"

namespace planecast::render {
namespace {

enum Attribute : GLuint { kPosition, kTexture, kColor };

Gl current_functions(GlContext& context) {
  context.make_current();
  return load_functions(context);
}

/// The part of a clip rectangle (left, top, right, bottom) inside the picture.
std::array<GLint, 4> clipped(const ImVec4& clip, const ImVec2& origin, int width, int height) {
  const int left = std::max(static_cast<int>(clip.x - origin.x), 0);
  const int top = std::max(static_cast<int>(clip.y - origin.y), 0);
  const int right = std::min(static_cast<int>(clip.z - origin.x), width);
  const int bottom = std::min(static_cast<int>(clip.w - origin.y), height);
  return {left, top, std::max(right - left, 0), std::max(bottom - top, 0)};
}

}  // namespace

struct ImGuiPainter::Impl {
  Impl(const std::string& shader_dir, ContextKind kind);

  void resize(int new_width, int new_height);
  void begin() const;
  void draw_list(const ImDrawList& list, const ImVec2& origin);
  void draw_command(const ImDrawCmd& command, const ImVec2& origin);

  std::unique_ptr<GlContext> context;
  Gl gl;
  ShaderLibrary shaders;
  std::map<TextureId, TextureHandle> textures;
  VertexArrayHandle vertex_array;
  BufferHandle vertices;
  BufferHandle indices;
  RenderbufferHandle color;
  FramebufferHandle framebuffer;
  int width = 0;
  int height = 0;
};

ImGuiPainter::Impl::Impl(const std::string& shader_dir, ContextKind kind)
    : context(create_context(kind)),
      gl(current_functions(*context)),
      shaders(gl, shader_dir),
      vertex_array(gl),
      vertices(gl),
      indices(gl) {
  const GLuint array = vertex_array.id();
  const auto attribute = [&](GLuint index, GLint count, GLenum type, bool unit, std::size_t at) {
    gl.EnableVertexArrayAttrib(array, index);
    gl.VertexArrayAttribFormat(array, index, count, type, unit ? GL_TRUE : GL_FALSE,
                               static_cast<GLuint>(at));
    gl.VertexArrayAttribBinding(array, index, 0);
  };
  attribute(kPosition, 2, GL_FLOAT, false, offsetof(ImDrawVert, pos));
  attribute(kTexture, 2, GL_FLOAT, false, offsetof(ImDrawVert, uv));
  attribute(kColor, 4, GL_UNSIGNED_BYTE, true, offsetof(ImDrawVert, col));
  gl.VertexArrayVertexBuffer(array, 0, vertices.id(), 0, sizeof(ImDrawVert));
  gl.VertexArrayElementBuffer(array, indices.id());
}

void ImGuiPainter::Impl::resize(int new_width, int new_height) {
  if (new_width == width && new_height == height) return;
  width = new_width;
  height = new_height;
  color = make_renderbuffer(gl, GL_RGBA8, 1, width, height);
  framebuffer = FramebufferHandle(gl);
  gl.NamedFramebufferRenderbuffer(framebuffer.id(), GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER,
                                  color.id());
  check_complete(gl, framebuffer, "the user interface");
}

void ImGuiPainter::Impl::begin() const {
  const std::array<float, 4> transparent{};
  gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer.id());
  gl.Disable(GL_SCISSOR_TEST);
  gl.ClearNamedFramebufferfv(framebuffer.id(), GL_COLOR, 0, transparent.data());
  gl.Viewport(0, 0, width, height);
  gl.Enable(GL_SCISSOR_TEST);
  gl.Enable(GL_BLEND);
  gl.BlendEquation(GL_FUNC_ADD);
  gl.BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
}

void ImGuiPainter::Impl::draw_list(const ImDrawList& list, const ImVec2& origin) {
  const auto size_of = [](const auto& buffer) { return static_cast<std::size_t>(buffer.Size); };
  upload(gl, vertices, std::span<const ImDrawVert>(list.VtxBuffer.Data, size_of(list.VtxBuffer)),
         GL_STREAM_DRAW);
  upload(gl, indices, std::span<const ImDrawIdx>(list.IdxBuffer.Data, size_of(list.IdxBuffer)),
         GL_STREAM_DRAW);
  for (const ImDrawCmd& command : list.CmdBuffer) draw_command(command, origin);
}

void ImGuiPainter::Impl::draw_command(const ImDrawCmd& command, const ImVec2& origin) {
  const auto texture = textures.find(reinterpret_cast<TextureId>(command.GetTexID()));
  const auto [x, y, w, h] = clipped(command.ClipRect, origin, width, height);
  if (texture == textures.end() || w == 0 || h == 0) return;
  gl.Scissor(x, y, w, h);
  gl.BindTextureUnit(0, texture->second.id());
  constexpr GLenum kIndexType = sizeof(ImDrawIdx) == 2 ? GL_UNSIGNED_SHORT : GL_UNSIGNED_INT;
  gl.DrawElementsBaseVertex(GL_TRIANGLES, static_cast<GLsizei>(command.ElemCount), kIndexType,
                            reinterpret_cast<const void*>(
                                static_cast<std::uintptr_t>(command.IdxOffset) * sizeof(ImDrawIdx)),
                            static_cast<GLint>(command.VtxOffset));
}

ImGuiPainter::ImGuiPainter(const std::string& shader_dir, ContextKind kind)
    : impl_(std::make_unique<Impl>(shader_dir, kind)) {}

ImGuiPainter::~ImGuiPainter() { impl_->context->make_current(); }

void ImGuiPainter::set_texture(TextureId id, const ImageU8& image) {
  impl_->context->make_current();
  TextureOptions options;
  options.wrap_s = options.wrap_t = GL_CLAMP_TO_EDGE;
  options.min_filter = GL_LINEAR;
  impl_->textures[id] = upload_image(impl_->gl, image, options);
}

ImageU8 ImGuiPainter::draw(const ImDrawData& data) {
  const int width = static_cast<int>(data.DisplaySize.x);
  const int height = static_cast<int>(data.DisplaySize.y);
  if (width < 1 || height < 1) throw std::invalid_argument("the user interface has no size");
  Impl& impl = *impl_;
  impl.context->make_current();
  impl.resize(width, height);
  impl.begin();
  const Program& program = impl.shaders.get("imgui.vert", "imgui.frag");
  program.use();
  program.set("size_px", glm::vec2(width, height));
  impl.gl.BindVertexArray(impl.vertex_array.id());
  for (int i = 0; i < data.CmdListsCount; ++i) {
    impl.draw_list(*data.CmdLists[i], data.DisplayPos);
  }
  ImageU8 picture(width, height, 4);
  impl.gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
  impl.gl.PixelStorei(GL_PACK_ROW_LENGTH, width);
  impl.gl.ReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, picture.pixels.data());
  if (impl.gl.GetError() != GL_NO_ERROR) throw std::runtime_error("OpenGL error in the interface");
  return picture;
}

}  // namespace planecast::render
