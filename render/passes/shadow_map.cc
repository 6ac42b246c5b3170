#include "render/passes/shadow_map.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/passes/texture_units.h"

namespace planecast::render {
namespace {

/// Rows: two axes across the light and the direction the light travels. The same for the same sun.
glm::mat3 light_from_world(const glm::vec3& direction_to_light) {
  const glm::vec3 away = -glm::normalize(direction_to_light);
  const glm::vec3 helper =
      std::abs(away.x) < 0.9F ? glm::vec3(1.0F, 0.0F, 0.0F) : glm::vec3(0.0F, 1.0F, 0.0F);
  const glm::vec3 across = glm::normalize(glm::cross(helper, away));
  return glm::transpose(glm::mat3(across, glm::cross(away, across), away));
}

SamplerHandle make_sampler(const Gl& gl, bool compare) {
  SamplerHandle sampler(gl);
  const GLuint id = sampler.id();
  const GLint filter = compare ? GL_LINEAR : GL_NEAREST;
  gl.SamplerParameteri(id, GL_TEXTURE_MIN_FILTER, filter);
  gl.SamplerParameteri(id, GL_TEXTURE_MAG_FILTER, filter);
  gl.SamplerParameteri(id, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
  gl.SamplerParameteri(id, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
  const std::array<float, 4> lit = {1.0F, 1.0F, 1.0F, 1.0F};
  gl.SamplerParameterfv(id, GL_TEXTURE_BORDER_COLOR, lit.data());
  if (compare) {
    gl.SamplerParameteri(id, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    gl.SamplerParameteri(id, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  }
  return sampler;
}

}  // namespace

ShadowProjection fit_shadow(const glm::vec3& direction_to_light, std::span<const glm::vec3> points,
                            int size, float margin_texels) {
  const glm::mat3 axes = light_from_world(direction_to_light);
  glm::vec3 low(-0.5F);
  glm::vec3 high(0.5F);
  if (!points.empty()) {
    low = high = axes * points.front();
    for (const glm::vec3& point : points) {
      const glm::vec3 p = axes * point;
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
  }
  // A flat or single-point caster must still have a box.
  const float smallest = std::max(1e-6F, 1e-4F * glm::length(high - low));
  const glm::vec3 center = 0.5F * (low + high);
  glm::vec3 half = glm::max(0.5F * (high - low), glm::vec3(smallest));
  const float grow = 1.0F / (1.0F - 2.0F * margin_texels / static_cast<float>(size));
  half.x = half.y = std::max(half.x, half.y) * grow;
  half.z = half.z * 1.01F;

  glm::mat4 clip(0.0F);
  for (int column = 0; column < 3; ++column) {
    clip[column] = glm::vec4(axes[column][0] / half.x, axes[column][1] / half.y,
                             axes[column][2] / (2.0F * half.z), 0.0F);
  }
  clip[3] =
      glm::vec4(-center.x / half.x, -center.y / half.y, 0.5F - center.z / (2.0F * half.z), 1.0F);
  ShadowProjection projection;
  projection.clip_from_world = clip;
  projection.extent_m = 2.0F * half.x;
  projection.texel_m = projection.extent_m / static_cast<float>(size);
  projection.depth_m = 2.0F * half.z;
  return projection;
}

ShadowMap::ShadowMap(const Gl& gl, int size)
    : gl_(&gl),
      size_(size),
      depth_(make_target(gl, GL_DEPTH_COMPONENT32F, size, size)),
      framebuffer_(gl),
      compare_(make_sampler(gl, true)),
      raw_(make_sampler(gl, false)) {
  gl.NamedFramebufferTexture(framebuffer_.id(), GL_DEPTH_ATTACHMENT, depth_.id(), 0);
  gl.NamedFramebufferDrawBuffers(framebuffer_.id(), 0, nullptr);
  check_complete(gl, framebuffer_, "shadows");
}

void ShadowMap::begin(const ShadowProjection& projection) {
  projection_ = projection;
  gl_->BindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
  gl_->Viewport(0, 0, size_, size_);
  gl_->Disable(GL_SCISSOR_TEST);
  gl_->DepthMask(GL_TRUE);
  const float farthest = 1.0F;
  gl_->ClearNamedFramebufferfv(framebuffer_.id(), GL_DEPTH, 0, &farthest);
  gl_->Enable(GL_DEPTH_TEST);
  gl_->DepthFunc(GL_LESS);
  gl_->Disable(GL_CULL_FACE);
  gl_->Disable(GL_BLEND);
}

std::vector<float> ShadowMap::read() const {
  std::vector<float> depths(static_cast<std::size_t>(size_) * static_cast<std::size_t>(size_));
  gl_->PixelStorei(GL_PACK_ALIGNMENT, 4);
  gl_->PixelStorei(GL_PACK_ROW_LENGTH, 0);
  gl_->GetTextureImage(depth_.id(), 0, GL_DEPTH_COMPONENT, GL_FLOAT,
                       static_cast<GLsizei>(depths.size() * sizeof(float)), depths.data());
  return depths;
}

void ShadowMap::bind(const Program& program, const Sun& sun) const {
  gl_->BindTextureUnit(kUnitShadowCompare, depth_.id());
  gl_->BindSampler(kUnitShadowCompare, compare_.id());
  gl_->BindTextureUnit(kUnitShadowRaw, depth_.id());
  gl_->BindSampler(kUnitShadowRaw, raw_.id());
  program.set("u_shadow_map", static_cast<int>(kUnitShadowCompare));
  program.set("u_shadow_depth", static_cast<int>(kUnitShadowRaw));
  program.set("u_shadow_from_world", projection_.clip_from_world);
  program.set("u_shadow_extent_m", projection_.extent_m);
  program.set("u_shadow_depth_m", projection_.depth_m);
  program.set("u_shadow_texel_m", projection_.texel_m);
  program.set("u_shadow_radius_m", sun.softness * projection_.texel_m);
}

}  // namespace planecast::render
