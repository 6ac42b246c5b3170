#include "render/passes/catchers.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/passes/content_hash.h"
#include "render/passes/texture_units.h"
#include "render/passes/view.h"

namespace planecast::render {
namespace {

constexpr int kMaskSide = 160;
/// Texels of a contact map for an object as wide as high, and at most; multiples of the 4 x 4
/// pattern.
constexpr int kContactSide = 144;
constexpr int kLargestContactSide = 288;
constexpr int kPenumbraSide = 512;
/// How far a contact shadow reaches, in heights of the object: there a wall hides 1 / (1 + 1.5^2)
/// of a direction's light, a column much less, and the rest fades out.
constexpr float kContactReach = 1.5F;
/// Below this cosine the sun grazes the plane and its shadow is endless.
constexpr float kSmallestCosine = 0.03F;

float luminance(const glm::vec3& color) {
  return glm::dot(color, glm::vec3(0.2126F, 0.7152F, 0.0722F));
}

/// Irradiance / pi on a plane from the surroundings; as diffuse_ambient in ambient.glsl.
glm::vec3 ambient_on(const std::array<glm::vec3, 9>& sh, const glm::vec3& n) {
  glm::vec3 sum = 0.282095F * sh[0];
  sum += 2.0F / 3.0F * 0.488603F * (n.y * sh[1] + n.z * sh[2] + n.x * sh[3]);
  sum += 0.25F * (1.092548F * (n.x * n.y * sh[4] + n.y * n.z * sh[5] + n.x * n.z * sh[7]) +
                  0.315392F * (3.0F * n.z * n.z - 1.0F) * sh[6] +
                  0.546274F * (n.x * n.x - n.y * n.y) * sh[8]);
  return glm::max(sum, glm::vec3(0.0F));
}

/// The casters as a plane sees them.
struct Silhouette {
  PlaneRegion footprint = nothing();
  float top = 0.0F;
  float underside = 0.0F;
};

Silhouette silhouette_of(const std::vector<glm::vec3>& points, const PlaneFrame& frame) {
  Silhouette found;
  found.top = -1e30F;
  found.underside = 1e30F;
  for (const glm::vec3& point : points) {
    const float height = frame.height(point);
    found.footprint.add(frame.coordinates(point));
    found.top = std::max(found.top, height);
    found.underside = std::min(found.underside, height);
  }
  return found;
}

/// Objects far off a plane, measured in their own width, leave hardly a trace on it: faded out, so
/// that it need not be computed.
float contact_strength(float lift) {
  constexpr float kFull = 0.25F;
  constexpr float kNone = 0.5F;
  return std::clamp((kNone - lift) / (kNone - kFull), 0.0F, 1.0F);
}

/// Objects spread over a plane need more texels than one.
int contact_side(const PlaneRegion& region, float reach_m) {
  const glm::vec2 size = region.size();
  constexpr float kRegionOfOne = (1.0F + 2.0F * kContactReach) / kContactReach;
  const float ones = std::max(size.x, size.y) / (kRegionOfOne * reach_m);
  const float side =
      std::clamp(static_cast<float>(kContactSide) * ones, static_cast<float>(kContactSide),
                 static_cast<float>(kLargestContactSide));
  return static_cast<int>(side) / 4 * 4;
}

/// Where the sun's shadow of the points can fall.
PlaneRegion sun_region(const std::vector<glm::vec3>& points, const PlaneFrame& frame,
                       const glm::vec3& to_light, float angular_radius) {
  const float cosine = glm::dot(frame.normal, to_light);
  const glm::vec2 slope =
      glm::vec2(glm::dot(frame.x, to_light), glm::dot(frame.y, to_light)) / cosine;
  PlaneRegion region = nothing();
  for (const glm::vec3& point : points) {
    const float height = std::max(frame.height(point), 0.0F);
    const glm::vec2 falls = frame.coordinates(point) - slope * height;
    const glm::vec2 blur(height * angular_radius / (cosine * cosine));
    region.add(falls - blur);
    region.add(falls + blur);
  }
  return region;
}

PlaneRegion united(const PlaneRegion& a, const PlaneRegion& b) {
  return {glm::min(a.min, b.min), glm::max(a.max, b.max)};
}

/// Maps the region to the whole target, whatever the height.
glm::mat4 clip_from_world_over(const PlaneFrame& frame, const PlaneRegion& region) {
  const glm::vec2 scale = 2.0F / region.size();
  const glm::vec2 center = 0.5F * (region.min + region.max);
  const glm::vec3 row_x = frame.x * scale.x;
  const glm::vec3 row_y = frame.y * scale.y;
  glm::mat4 clip(0.0F);
  for (int column = 0; column < 3; ++column) {
    clip[column] = glm::vec4(row_x[column], row_y[column], 0.0F, 0.0F);
  }
  clip[3] = glm::vec4(-glm::dot(row_x, frame.origin) - center.x * scale.x,
                      -glm::dot(row_y, frame.origin) - center.y * scale.y, 0.5F, 1.0F);
  return clip;
}

std::uint64_t patch_hash(const PlanePatch& patch) {
  ContentHash hash;
  hash.add(patch.normal);
  hash.add(patch.outer);
  for (const auto& hole : patch.holes) hash.add(hole);
  return hash.value();
}

void set_filter(const Gl& gl, const TextureHandle& texture, GLint min_filter) {
  gl.TextureParameteri(texture.id(), GL_TEXTURE_MIN_FILTER, min_filter);
  gl.TextureParameteri(texture.id(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
}

TextureHandle make_penumbra_texture(const Gl& gl) {
  TextureHandle texture(gl);
  const GLuint id = texture.id();
  gl.TextureStorage2D(id, 10, GL_RG32F, kPenumbraSide, kPenumbraSide);
  set_filter(gl, texture, GL_LINEAR_MIPMAP_LINEAR);
  // The default border is black: nothing blocks the light there.
  gl.TextureParameteri(id, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
  gl.TextureParameteri(id, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
  return texture;
}

}  // namespace

CatcherPass::CatcherPass(const Gl& gl, const ModelPasses& models)
    : gl_(&gl), models_(&models), no_vertices_(gl), framebuffer_(gl) {}

void CatcherPass::prepare(ShaderLibrary& shaders, const CatcherInput& input) {
  prepared_.clear();
  for (auto& [hash, mask] : masks_) mask.used = false;
  for (patch_index_ = 0; patch_index_ < input.scene->catchers.size(); ++patch_index_) {
    const PlanePatch& patch = input.scene->catchers[patch_index_];
    if (drawable(patch) && !input.items->empty()) prepare_patch(shaders, input, patch);
  }
  std::erase_if(masks_, [](const auto& item) { return !item.second.used; });
}

void CatcherPass::prepare_patch(ShaderLibrary& shaders, const CatcherInput& input,
                                const PlanePatch& patch) {
  const Light& light = input.scene->light;
  Prepared prepared;
  prepared.frame = plane_frame(patch);
  prepared.edge_softness_m = patch.edge_softness_m;
  const PlaneFrame& frame = prepared.frame;
  if (frame.height(camera_position(*input.camera)) <= 0.0F) return;
  const Silhouette casters = silhouette_of(*input.caster_points, frame);
  if (casters.top <= 0.0F) return;

  const glm::vec3 to_light = glm::normalize(light.sun.direction_to_light);
  const float cosine = glm::dot(frame.normal, to_light);
  const float ambient = luminance(ambient_on(light.ambient_sh, frame.normal));
  const float sun = luminance(light.sun.radiance) * std::max(cosine, 0.0F);
  if (ambient + sun <= 0.0F) return;
  prepared.sun_share = sun / (ambient + sun);
  prepared.sun = input.shadow != nullptr && cosine > kSmallestCosine;
  prepared.farthest_gap_m = casters.top / std::max(cosine, kSmallestCosine);

  const PlaneRegion outer = outer_region(patch, frame);
  const glm::vec2 width = casters.footprint.size();
  const float reach = kContactReach * casters.top;
  PlaneRegion contact = nothing();
  prepared.contact_strength = contact_strength(casters.underside / std::max(width.x, width.y));
  if (ambient > 0.0F && prepared.contact_strength > 0.0F) {
    contact = {casters.footprint.min - reach, casters.footprint.max + reach};
  }
  PlaneRegion touched = contact;
  if (prepared.sun) {
    touched = united(
        touched, sun_region(*input.caster_points, frame, to_light, light.sun.angular_radius_rad));
  }
  prepared.region = intersection(outer, touched);
  if (prepared.region.empty()) return;
  if (!intersection(outer, contact).empty()) prepared.contact_region = contact;
  if (projected_bounds(*input.camera, frame.corners(prepared.region)).width == 0) return;

  prepared.mask = &mask_of(patch, frame);
  Maps& maps = maps_[patch_index_];
  ContentHash signature;
  signature.add(input.casters);
  signature.add(patch_hash(patch));
  if (maps.casters != signature.value()) {
    maps.casters = signature.value();
    if (prepared.sun) make_penumbra(shaders, input, frame, maps);
    if (!prepared.contact_region.empty()) {
      make_contact(shaders, input, frame, contact, reach, maps);
    }
  }
  prepared.maps = &maps;
  prepared_.push_back(prepared);
}

const CatcherPass::Mask& CatcherPass::mask_of(const PlanePatch& patch, const PlaneFrame& frame) {
  const auto [place, is_new] = masks_.try_emplace(patch_hash(patch));
  Mask& mask = place->second;
  mask.used = true;
  if (!is_new) return mask;
  mask.region = outer_region(patch, frame);
  const ImageF distance = distance_to_edge(patch, frame, mask.region, kMaskSide);
  mask.texture = make_target(*gl_, GL_R32F, distance.width, distance.height);
  set_filter(*gl_, mask.texture, GL_LINEAR);
  gl_->PixelStorei(GL_UNPACK_ALIGNMENT, 4);
  gl_->TextureSubImage2D(mask.texture.id(), 0, 0, 0, distance.width, distance.height, GL_RED,
                         GL_FLOAT, distance.pixels.data());
  return mask;
}

void CatcherPass::begin_map(GLuint texture, int size) const {
  gl_->NamedFramebufferTexture(framebuffer_.id(), GL_COLOR_ATTACHMENT0, texture, 0);
  gl_->BindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
  gl_->Viewport(0, 0, size, size);
  gl_->Disable(GL_SCISSOR_TEST);
  gl_->Disable(GL_DEPTH_TEST);
  gl_->Disable(GL_CULL_FACE);
  gl_->Disable(GL_BLEND);
}

void CatcherPass::make_penumbra(ShaderLibrary& shaders, const CatcherInput& input,
                                const PlaneFrame& frame, Maps& maps) {
  if (!maps.penumbra) maps.penumbra = make_penumbra_texture(*gl_);
  const ShadowProjection& projection = input.shadow->projection();
  const Program& program = shaders.get("full_screen.vert", "penumbra.frag");
  begin_map(maps.penumbra.id(), kPenumbraSide);
  program.use();
  input.shadow->bind(program, input.scene->light.sun, true);
  program.set("u_factor", std::max(1, input.shadow->size() / kPenumbraSide));
  const glm::mat4 world_from_clip = glm::inverse(projection.clip_from_world);
  program.set("u_plane", glm::transpose(world_from_clip) * frame.equation());
  gl_->BindVertexArray(no_vertices_.id());
  gl_->DrawArrays(GL_TRIANGLES, 0, 3);
  gl_->GenerateTextureMipmap(maps.penumbra.id());
}

void CatcherPass::make_contact(ShaderLibrary& shaders, const CatcherInput& input,
                               const PlaneFrame& frame, const PlaneRegion& region, float reach_m,
                               Maps& maps) {
  const int side = contact_side(region, reach_m);
  if (contact_side_ != side) {
    contact_side_ = side;
    heights_ = make_target(*gl_, GL_RG32F, side, side);
    unblurred_contact_ = make_target(*gl_, GL_R32F, side, side);
  }
  if (maps.contact_side != side) {
    maps.contact_side = side;
    maps.contact = make_target(*gl_, GL_R32F, side, side);
    set_filter(*gl_, maps.contact, GL_LINEAR);
  }
  begin_map(heights_.id(), side);
  constexpr std::array<float, 4> kNothingThere = {-1e9F, -1e9F, 0.0F, 0.0F};
  gl_->ClearNamedFramebufferfv(framebuffer_.id(), GL_COLOR, 0, kNothingThere.data());
  gl_->Enable(GL_BLEND);
  gl_->BlendEquation(GL_MAX);
  gl_->BlendFunc(GL_ONE, GL_ONE);
  models_->draw_heights(*input.items, clip_from_world_over(frame, region), frame.equation());
  gl_->BlendEquation(GL_FUNC_ADD);

  const Program& program = shaders.get("full_screen.vert", "contact.frag");
  begin_map(unblurred_contact_.id(), side);
  program.use();
  gl_->BindTextureUnit(kUnitHeights, heights_.id());
  program.set("u_heights", static_cast<int>(kUnitHeights));
  program.set("u_region_size_m", region.size());
  program.set("u_reach_m", reach_m);
  gl_->BindVertexArray(no_vertices_.id());
  gl_->DrawArrays(GL_TRIANGLES, 0, 3);

  const Program& blur = shaders.get("full_screen.vert", "contact_blur.frag");
  begin_map(maps.contact.id(), side);
  blur.use();
  gl_->BindTextureUnit(kUnitHeights, unblurred_contact_.id());
  blur.set("u_heights", static_cast<int>(kUnitHeights));
  gl_->DrawArrays(GL_TRIANGLES, 0, 3);
}

std::vector<glm::vec3> CatcherPass::touched_points() const {
  std::vector<glm::vec3> points;
  for (const Prepared& prepared : prepared_) {
    const auto corners = prepared.frame.corners(prepared.region);
    points.insert(points.end(), corners.begin(), corners.end());
  }
  return points;
}

void CatcherPass::draw(ShaderLibrary& shaders, const CatcherInput& input, GLuint occluder_depth,
                       float occluder_tolerance) const {
  gl_->Enable(GL_DEPTH_TEST);
  gl_->DepthFunc(GL_GREATER);
  gl_->DepthMask(GL_FALSE);
  gl_->Disable(GL_CULL_FACE);
  gl_->Enable(GL_BLEND);
  gl_->BlendEquation(GL_FUNC_ADD);
  gl_->BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  gl_->BindVertexArray(no_vertices_.id());
  const Camera& camera = *input.camera;
  const Sun& sun = input.scene->light.sun;
  for (const Prepared& prepared : prepared_) {
    std::vector<std::string> defines;
    if (!prepared.contact_region.empty()) defines.emplace_back("CONTACT");
    if (prepared.sun) defines.emplace_back("SUN");
    if (occluder_depth != 0) defines.emplace_back("OCCLUDER_DEPTH");
    const Program& program = shaders.get("plane_quad.vert", "catcher.frag", defines);
    program.use();
    program.set("u_clip_from_world", clip_from_camera(camera) * camera.camera_from_world);
    program.set("u_origin", prepared.frame.origin);
    program.set("u_axis_x", prepared.frame.x);
    program.set("u_axis_y", prepared.frame.y);
    program.set("u_region_min", prepared.region.min);
    program.set("u_region_max", prepared.region.max);
    program.set("u_mask", static_cast<int>(kUnitMask));
    program.set("u_mask_min", prepared.mask->region.min);
    program.set("u_mask_max", prepared.mask->region.max);
    program.set("u_edge_softness_m", prepared.edge_softness_m);
    program.set("u_sun_share", prepared.sun_share);
    program.set("u_strength", std::clamp(input.scene->shadow_strength, 0.0F, 1.0F));
    gl_->BindTextureUnit(kUnitMask, prepared.mask->texture.id());
    if (!prepared.contact_region.empty()) {
      gl_->BindTextureUnit(kUnitContact, prepared.maps->contact.id());
      program.set("u_contact", static_cast<int>(kUnitContact));
      program.set("u_contact_strength", prepared.contact_strength);
      program.set("u_contact_min", prepared.contact_region.min);
      program.set("u_contact_max", prepared.contact_region.max);
    }
    if (prepared.sun) {
      const ShadowProjection& projection = input.shadow->projection();
      const float texel_m = projection.extent_m / static_cast<float>(kPenumbraSide);
      gl_->BindTextureUnit(kUnitHeights, prepared.maps->penumbra.id());
      program.set("u_penumbra", static_cast<int>(kUnitHeights));
      program.set("u_shadow_from_world", projection.clip_from_world);
      program.set("u_penumbra_texel_m", texel_m);
      program.set("u_penumbra_extent_m", projection.extent_m);
      program.set("u_light_tangent", std::tan(std::clamp(sun.angular_radius_rad, 0.0F, 0.5F)));
      program.set("u_farthest_gap_m", prepared.farthest_gap_m);
      program.set("u_smallest_radius_m", sun.softness * projection.texel_m);
    }
    if (occluder_depth != 0) {
      gl_->BindTextureUnit(kUnitOccluderDepth, occluder_depth);
      program.set("u_occluder_depth", static_cast<int>(kUnitOccluderDepth));
      program.set("u_occluder_tolerance", occluder_tolerance);
    }
    gl_->DrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  }
  gl_->Disable(GL_BLEND);
  gl_->DepthMask(GL_TRUE);
}

void CatcherPass::clear() {
  prepared_.clear();
  maps_.clear();
  masks_.clear();
}

}  // namespace planecast::render
