#include "render/passes/sun_shadow.h"

#include "render/passes/content_hash.h"

namespace planecast::render {

bool casts(const Sun& sun) { return sun.casts_shadow && sun.radiance != glm::vec3(0.0F); }

ShadowProjection fit_sun(const Sun& sun, const std::vector<glm::vec3>& points, int size) {
  const float margin_texels = 3.0F + 2.0F * sun.softness;
  return fit_shadow(sun.direction_to_light, points, size, margin_texels);
}

std::uint64_t caster_signature(const ModelSet& models, const Sun& sun) {
  ContentHash hash;
  hash.add(models.signature());
  hash.add(sun.direction_to_light);
  hash.add(sun.softness);
  hash.add(casts(sun));
  return hash.value();
}

SunShadow::SunShadow(const Gl& gl, int size, float detail_texels)
    : gl_(&gl), map_(gl, size), detail_texels_(detail_texels) {}

const ShadowMap* SunShadow::update(const Sun& sun, const Casters& casters,
                                   const ModelPasses& models, ShaderLibrary& shaders) {
  if (!casts(sun)) return nullptr;
  if (casters.signature == signature_) return &map_;
  signature_ = casters.signature;
  const ShadowProjection projection = fit_sun(sun, *casters.points, map_.size());
  map_.begin(projection);
  gl_->Enable(GL_POLYGON_OFFSET_FILL);
  gl_->PolygonOffset(kCasterSlopeTexels, 0.0F);
  if (casters.surfaces != nullptr) {
    casters.surfaces->draw_shadow(shaders, projection, glm::normalize(sun.direction_to_light));
  }
  models.draw_depth(*casters.items, projection.clip_from_world,
                    detail_texels_ * projection.texel_m);
  gl_->Disable(GL_POLYGON_OFFSET_FILL);
  return &map_;
}

}  // namespace planecast::render
