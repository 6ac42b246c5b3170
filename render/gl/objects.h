#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "render/gl/functions.h"

namespace planecast::render {

/// Owns one OpenGL name; deletes it by `Traits::destroy`. The context must be current at
/// destruction.
template <typename Traits>
class GlHandle {
 public:
  GlHandle() = default;
  explicit GlHandle(const Gl& gl) : gl_(&gl), id_(Traits::create(gl)) {}
  ~GlHandle() { reset(); }
  GlHandle(GlHandle&& other) noexcept
      : gl_(std::exchange(other.gl_, nullptr)), id_(std::exchange(other.id_, 0)) {}
  GlHandle& operator=(GlHandle&& other) noexcept {
    if (this != &other) {
      reset();
      gl_ = std::exchange(other.gl_, nullptr);
      id_ = std::exchange(other.id_, 0);
    }
    return *this;
  }

  GLuint id() const { return id_; }
  explicit operator bool() const { return id_ != 0; }

 private:
  void reset() {
    if (gl_ != nullptr && id_ != 0) Traits::destroy(*gl_, id_);
    gl_ = nullptr;
    id_ = 0;
  }

  const Gl* gl_ = nullptr;
  GLuint id_ = 0;
};

#define PLANECAST_GL_TRAITS(name, create_call, destroy_call)         \
  struct name##Traits {                                              \
    static GLuint create(const Gl& gl) {                             \
      GLuint id = 0;                                                 \
      (create_call);                                                 \
      return id;                                                     \
    }                                                                \
    static void destroy(const Gl& gl, GLuint id) { (destroy_call); } \
  };                                                                 \
  using name = GlHandle<name##Traits>;

PLANECAST_GL_TRAITS(BufferHandle, gl.CreateBuffers(1, &id), gl.DeleteBuffers(1, &id))
PLANECAST_GL_TRAITS(TextureHandle, gl.CreateTextures(GL_TEXTURE_2D, 1, &id),
                    gl.DeleteTextures(1, &id))
PLANECAST_GL_TRAITS(CubeTextureHandle, gl.CreateTextures(GL_TEXTURE_CUBE_MAP, 1, &id),
                    gl.DeleteTextures(1, &id))
PLANECAST_GL_TRAITS(SamplerHandle, gl.CreateSamplers(1, &id), gl.DeleteSamplers(1, &id))
PLANECAST_GL_TRAITS(FramebufferHandle, gl.CreateFramebuffers(1, &id), gl.DeleteFramebuffers(1, &id))
PLANECAST_GL_TRAITS(RenderbufferHandle, gl.CreateRenderbuffers(1, &id),
                    gl.DeleteRenderbuffers(1, &id))
PLANECAST_GL_TRAITS(VertexArrayHandle, gl.CreateVertexArrays(1, &id), gl.DeleteVertexArrays(1, &id))
PLANECAST_GL_TRAITS(ProgramHandle, id = gl.CreateProgram(), gl.DeleteProgram(id))
#undef PLANECAST_GL_TRAITS

/// A buffer filled once (or again with upload).
template <typename T>
void upload(const Gl& gl, const BufferHandle& buffer, std::span<const T> data,
            GLenum usage = GL_STATIC_DRAW) {
  gl.NamedBufferData(buffer.id(), static_cast<GLsizeiptr>(data.size_bytes()), data.data(), usage);
}

/// One level, no filter: the target of a pass. Its texels read nearest unless a sampler says else.
TextureHandle make_target(const Gl& gl, GLenum format, int width, int height);

/// Multisampled (or, with one sample, plain) renderbuffer.
RenderbufferHandle make_renderbuffer(const Gl& gl, GLenum format, int samples, int width,
                                     int height);

/// Throws std::runtime_error naming `what` when the framebuffer is incomplete.
void check_complete(const Gl& gl, const FramebufferHandle& framebuffer, const char* what);

}  // namespace planecast::render
