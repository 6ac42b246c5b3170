#include "render/gl/functions.h"

#include <stdexcept>
#include <string>

#include "render/context/context.h"

namespace planecast::render {

Gl load_functions(const GlContext& context) {
  Gl gl;
#define PLANECAST_GL_LOAD(type, name)                             \
  gl.name = reinterpret_cast<type>(context.function("gl" #name)); \
  if (gl.name == nullptr) throw std::runtime_error("OpenGL lacks gl" #name);
  PLANECAST_GL_FUNCTIONS(PLANECAST_GL_LOAD)
#undef PLANECAST_GL_LOAD
  GLint major = 0;
  GLint minor = 0;
  gl.GetIntegerv(GL_MAJOR_VERSION, &major);
  gl.GetIntegerv(GL_MINOR_VERSION, &minor);
  if (major * 10 + minor < 45) {
    throw std::runtime_error("OpenGL 4.5 is needed, the driver has " + std::to_string(major) + "." +
                             std::to_string(minor));
  }
  return gl;
}

}  // namespace planecast::render
