#include "render/passes/catchers.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

#include "render/passes/content_hash.h"
#include "render/passes/texture_units.h"
#include "render/passes/view.h"

namespace planecast::render {
namespace {

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

void set_filter(const Gl& gl, const TextureHandle& texture, GLint min_filter) {
  gl.TextureParameteri(texture.id(), GL_TEXTURE_MIN_FILTER, min_filter);
  gl.TextureParameteri(texture.id(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
}

TextureHandle make_penumbra_texture(const Gl& gl, int side) {
  TextureHandle texture(gl);
  const GLuint id = texture.id();
  gl.TextureStorage2D(id, std::bit_width(static_cast<unsigned>(side)), GL_RG32F, side, side);
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
  for (const PlannedCatcher& planned :
       plan_catchers(*input.scene, *input.camera, *input.caster_points, input.shadow != nullptr)) {
    const PlanePatch& patch = input.scene->catchers[planned.patch];
    const CatcherPlan& plan = planned.plan;
    Maps& maps = maps_[planned.patch];
    ContentHash signature;
    signature.add(map_signature(planned, *input.scene, input.casters));
    signature.add(input.still);
    Prepared prepared{plan, &mask_of(patch, plan.frame, planned.hash), &maps,
                      patch.edge_softness_m};
    if (maps.signature != signature.value()) {
      maps.signature = signature.value();
      if (plan.sun && input.shadow != nullptr) make_penumbra(shaders, input, plan.frame, maps);
      if (!plan.contact_region.empty()) make_contact(shaders, input, plan, maps);
      if (input.still) bake(shaders, input, prepared, maps);
    }
    if (!prepared.drawn(input.still).empty()) prepared_.push_back(prepared);
  }
  std::erase_if(masks_, [](const auto& item) { return !item.second.used; });
}

const CatcherPass::Mask& CatcherPass::mask_of(const PlanePatch& patch, const PlaneFrame& frame,
                                              std::uint64_t hash) {
  const auto [place, is_new] = masks_.try_emplace(hash);
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
  const int factor = penumbra_factor(input.shadow->size());
  const int side = input.shadow->size() / factor;
  if (!maps.penumbra) maps.penumbra = make_penumbra_texture(*gl_, side);
  const ShadowProjection& projection = input.shadow->projection();
  const Program& program = shaders.get("full_screen.vert", "penumbra.frag");
  begin_map(maps.penumbra.id(), side);
  program.use();
  input.shadow->bind(program, input.scene->light.sun);
  program.set("u_factor", factor);
  const glm::mat4 world_from_clip = glm::inverse(projection.clip_from_world);
  program.set("u_plane", glm::transpose(world_from_clip) * frame.equation());
  gl_->BindVertexArray(no_vertices_.id());
  gl_->DrawArrays(GL_TRIANGLES, 0, 3);
  gl_->GenerateTextureMipmap(maps.penumbra.id());
}

void CatcherPass::make_contact(ShaderLibrary& shaders, const CatcherInput& input,
                               const CatcherPlan& plan, Maps& maps) {
  const int side = plan.contact_side;
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
  models_->draw_heights(
      *input.items, clip_from_world_over(plan.frame, plan.contact_region), plan.frame.equation(),
      input.detail_texels * plan.contact_region.size().x / static_cast<float>(side));
  gl_->BlendEquation(GL_FUNC_ADD);

  const Program& program = shaders.get("full_screen.vert", "contact.frag");
  begin_map(unblurred_contact_.id(), side);
  program.use();
  gl_->BindTextureUnit(kUnitHeights, heights_.id());
  program.set("u_heights", static_cast<int>(kUnitHeights));
  program.set("u_region_size_m", plan.contact_region.size());
  program.set("u_reach_m", plan.contact_reach_m);
  gl_->BindVertexArray(no_vertices_.id());
  gl_->DrawArrays(GL_TRIANGLES, 0, 3);

  const Program& blur = shaders.get("full_screen.vert", "contact_blur.frag");
  begin_map(maps.contact.id(), side);
  blur.use();
  gl_->BindTextureUnit(kUnitHeights, unblurred_contact_.id());
  blur.set("u_heights", static_cast<int>(kUnitHeights));
  gl_->DrawArrays(GL_TRIANGLES, 0, 3);
}

void CatcherPass::bake(ShaderLibrary& shaders, const CatcherInput& input, const Prepared& prepared,
                       Maps& maps) {
  if (!maps.baked) {
    maps.baked = TextureHandle(*gl_);
    gl_->TextureStorage2D(maps.baked.id(), std::bit_width(static_cast<unsigned>(kBakedSide)),
                          GL_RGBA8, kBakedSide, kBakedSide);
    set_filter(*gl_, maps.baked, GL_LINEAR_MIPMAP_LINEAR);
    gl_->TextureParameteri(maps.baked.id(), GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl_->TextureParameteri(maps.baked.id(), GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  }
  std::vector<std::string> defines = {"BAKE"};
  if (!prepared.plan.contact_region.empty()) defines.emplace_back("CONTACT");
  if (prepared.plan.sun) defines.emplace_back("SUN");
  const Program& program = shaders.get("plane_quad.vert", "catcher.frag", defines);
  begin_map(maps.baked.id(), kBakedSide);
  program.use();
  program.set("u_clip_from_world", clip_from_world_over(prepared.plan.frame, prepared.plan.region));
  set_plane(program, prepared.plan.frame, prepared.plan.region);
  set_shadow_inputs(program, input, prepared);
  gl_->BindVertexArray(no_vertices_.id());
  gl_->DrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  ImageU8 baked(kBakedSide, kBakedSide, 4);
  gl_->PixelStorei(GL_PACK_ALIGNMENT, 1);
  gl_->PixelStorei(GL_PACK_ROW_LENGTH, 0);
  gl_->ReadPixels(0, 0, kBakedSide, kBakedSide, GL_RGBA, GL_UNSIGNED_BYTE, baked.pixels.data());
  maps.dark = dark_part(baked, prepared.plan.region);
  gl_->GenerateTextureMipmap(maps.baked.id());
}

std::vector<glm::vec3> CatcherPass::touched_points(const CatcherInput& input) const {
  std::vector<glm::vec3> points;
  for (const Prepared& prepared : prepared_) {
    const auto corners = prepared.plan.frame.corners(prepared.drawn(input.still));
    points.insert(points.end(), corners.begin(), corners.end());
  }
  return points;
}

void CatcherPass::set_plane(const Program& program, const PlaneFrame& frame,
                            const PlaneRegion& region) const {
  program.set("u_origin", frame.origin);
  program.set("u_axis_x", frame.x);
  program.set("u_axis_y", frame.y);
  program.set("u_region_min", region.min);
  program.set("u_region_max", region.max);
}

void CatcherPass::set_shadow_inputs(const Program& program, const CatcherInput& input,
                                    const Prepared& prepared) const {
  gl_->BindTextureUnit(kUnitMask, prepared.mask->texture.id());
  program.set("u_mask", static_cast<int>(kUnitMask));
  program.set("u_mask_min", prepared.mask->region.min);
  program.set("u_mask_max", prepared.mask->region.max);
  program.set("u_edge_softness_m", prepared.edge_softness_m);
  if (!prepared.plan.contact_region.empty()) {
    gl_->BindTextureUnit(kUnitContact, prepared.maps->contact.id());
    program.set("u_contact", static_cast<int>(kUnitContact));
    program.set("u_contact_strength", prepared.plan.contact_strength);
    program.set("u_contact_min", prepared.plan.contact_region.min);
    program.set("u_contact_max", prepared.plan.contact_region.max);
  }
  if (prepared.plan.sun) {
    const Sun& sun = input.scene->light.sun;
    const ShadowProjection& projection = input.shadow->projection();
    const int factor = penumbra_factor(input.shadow->size());
    gl_->BindTextureUnit(kUnitHeights, prepared.maps->penumbra.id());
    program.set("u_penumbra", static_cast<int>(kUnitHeights));
    program.set("u_shadow_from_world", projection.clip_from_world);
    program.set("u_penumbra_texel_m", projection.texel_m * static_cast<float>(factor));
    program.set("u_penumbra_extent_m", projection.extent_m);
    program.set("u_light_tangent", light_tangent(sun));
    program.set("u_farthest_gap_m", prepared.plan.farthest_gap_m);
    program.set("u_smallest_radius_m", sun.softness * projection.texel_m);
  }
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
  for (const Prepared& prepared : prepared_) {
    std::vector<std::string> defines;
    if (input.still) defines.emplace_back("BAKED");
    if (!input.still && !prepared.plan.contact_region.empty()) defines.emplace_back("CONTACT");
    if (!input.still && prepared.plan.sun) defines.emplace_back("SUN");
    if (occluder_depth != 0) defines.emplace_back("OCCLUDER_DEPTH");
    const Program& program = shaders.get("plane_quad.vert", "catcher.frag", defines);
    program.use();
    program.set("u_clip_from_world", clip_from_camera(camera) * camera.camera_from_world);
    set_plane(program, prepared.plan.frame, prepared.drawn(input.still));
    program.set("u_sun_share", prepared.plan.sun_share);
    program.set("u_strength", std::clamp(input.scene->shadow_strength, 0.0F, 1.0F));
    if (input.still) {
      gl_->BindTextureUnit(kUnitBaked, prepared.maps->baked.id());
      program.set("u_baked", static_cast<int>(kUnitBaked));
      program.set("u_baked_min", prepared.plan.region.min);
      program.set("u_baked_max", prepared.plan.region.max);
    } else {
      set_shadow_inputs(program, input, prepared);
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
