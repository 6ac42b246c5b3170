#include "render/gl/objects.h"

#include <stdexcept>
#include <string>

namespace planecast::render {

TextureHandle make_target(const Gl& gl, GLenum format, int width, int height) {
  TextureHandle texture(gl);
  gl.TextureStorage2D(texture.id(), 1, format, width, height);
  gl.TextureParameteri(texture.id(), GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl.TextureParameteri(texture.id(), GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  gl.TextureParameteri(texture.id(), GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  gl.TextureParameteri(texture.id(), GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  return texture;
}

RenderbufferHandle make_renderbuffer(const Gl& gl, GLenum format, int samples, int width,
                                     int height) {
  RenderbufferHandle buffer(gl);
  gl.NamedRenderbufferStorageMultisample(buffer.id(), samples > 1 ? samples : 0, format, width,
                                         height);
  return buffer;
}

void check_complete(const Gl& gl, const FramebufferHandle& framebuffer, const char* what) {
  if (gl.CheckNamedFramebufferStatus(framebuffer.id(), GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    throw std::runtime_error(std::string("OpenGL refuses the framebuffer for ") + what);
  }
}

}  // namespace planecast::render
