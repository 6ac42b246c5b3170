#include "render/passes/environment_map.h"

namespace planecast::render {

GLuint EnvironmentMap::texture(const std::shared_ptr<const Environment>& environment) {
  if (environment == uploaded_) return texture_.id();
  uploaded_ = environment;
  texture_ = CubeTextureHandle(*gl_);
  const int levels = environment->levels();
  gl_->TextureStorage2D(texture_.id(), levels, GL_RGBA16F, environment->side(0),
                        environment->side(0));
  gl_->TextureParameteri(texture_.id(), GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  gl_->TextureParameteri(texture_.id(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  gl_->PixelStorei(GL_UNPACK_ALIGNMENT, 4);
  for (int level = 0; level < levels; ++level) {
    const int side = environment->side(level);
    gl_->TextureSubImage3D(texture_.id(), level, 0, 0, 0, side, side, 6, GL_RGB, GL_FLOAT,
                           environment->texels(level).data());
  }
  return texture_.id();
}

void EnvironmentMap::clear() {
  texture_ = {};
  uploaded_.reset();
}

}  // namespace planecast::render
