#include "render/passes/model_passes.h"

#include <algorithm>
#include <string>

#include "render/passes/texture_units.h"
#include "render/passes/view.h"

namespace planecast::render {
namespace {

/// Blended surfaces have no depth or shadow of their own below half opacity.
constexpr float kBlendCutoff = 0.5F;

/// Where the passes that need no colour look at the texture's alpha.
bool cut_out(const Material& material) { return material.alpha_mode != AlphaMode::kOpaque; }

bool is_surface(const DrawItem& item) { return item.mode == GL_TRIANGLES; }

float view_depth(const DrawItem& item, const Camera& camera) {
  const glm::vec4 center(0.5F * (item.box.min + item.box.max), 1.0F);
  return (camera.camera_from_world * item.world_from_shape * center).z;
}

bool has(const TextureSlot& slot) { return slot.texture >= 0; }

void add_layer_variants(const Material& material, std::vector<std::string>& defines) {
  const auto when = [&defines](bool condition, const char* name) {
    if (condition) defines.emplace_back(name);
    return condition;
  };
  if (when(!plain_reflectance(material), "SPECULAR")) {
    when(has(material.specular_map), "SPECULAR_MAP");
    when(has(material.specular_color_map), "SPECULAR_COLOR_MAP");
  }
  if (when(material.transmission > 0.0F, "TRANSMISSION")) {
    when(has(material.transmission_map), "TRANSMISSION_MAP");
  }
  if (when(material.clearcoat > 0.0F, "CLEARCOAT")) {
    when(has(material.clearcoat_map), "CLEARCOAT_MAP");
    when(has(material.clearcoat_roughness_map), "CLEARCOAT_ROUGHNESS_MAP");
    when(has(material.clearcoat_normal_map), "CLEARCOAT_NORMAL_MAP");
  }
  if (when(material.sheen_color != glm::vec3(0.0F), "SHEEN")) {
    when(has(material.sheen_color_map), "SHEEN_COLOR_MAP");
    when(has(material.sheen_roughness_map), "SHEEN_ROUGHNESS_MAP");
  }
}

std::vector<std::string> shading_variant(const DrawItem& item, const ShadingInput& input,
                                         bool lamps) {
  const Material& material = *item.material;
  std::vector<std::string> defines;
  const auto when = [&defines](bool condition, const char* name) {
    if (condition) defines.emplace_back(name);
  };
  const bool sun = input.light->sun.radiance != glm::vec3(0.0F);
  when(has(material.base_color_map), "BASE_COLOR_MAP");
  when(base_color_use(item) == TextureUse::kEncoded, "BASE_COLOR_ENCODED");
  when(material.alpha_mode == AlphaMode::kMask, "ALPHA_MASK");
  when(material.alpha_mode == AlphaMode::kMask && input.multisampled, "SAMPLE_COVERAGE");
  when(material.alpha_mode == AlphaMode::kBlend, "ALPHA_BLEND");
  when(input.occluder_depth != 0, "OCCLUDER_DEPTH");
  when(input.tone_map == ToneMap::kNeutral, "TONE_NEUTRAL");
  if (material.unlit || item.unlit) {
    defines.emplace_back("UNLIT");
    return defines;
  }
  when(has(material.metallic_roughness_map), "METALLIC_ROUGHNESS_MAP");
  when(has(material.normal_map), "NORMAL_MAP");
  when(has(material.occlusion_map), "OCCLUSION_MAP");
  when(has(material.emissive_map), "EMISSIVE_MAP");
  when(sun, "SUN");
  when(sun && input.shadow != nullptr, "SHADOWS");
  when(lamps, "LAMPS");
  when(input.environment != 0, "ENVIRONMENT");
  add_layer_variants(material, defines);
  return defines;
}

}  // namespace

glm::mat3 normal_matrix(const glm::mat4& matrix) {
  const glm::mat3 m(matrix);
  const glm::mat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  return glm::determinant(m) < 0.0F ? -cofactors : cofactors;
}

float allowed_error_m(const DrawItem& item, const Camera& camera, float pixels) {
  float nearest = camera.far_plane;
  for (const glm::vec3& corner : box_corners(item.box, item.world_from_shape)) {
    nearest = std::min(nearest, (camera.camera_from_world * glm::vec4(corner, 1.0F)).z);
  }
  const float focal = std::max(std::abs(camera.fx), std::abs(camera.fy));
  return pixels * std::max(nearest, camera.near_plane) / focal;
}

bool plain_reflectance(const Material& material) {
  return material.ior == 1.5F && material.specular == 1.0F &&
         material.specular_color == glm::vec3(1.0F) && !has(material.specular_map) &&
         !has(material.specular_color_map);
}

void ModelPasses::bind_map(const DrawItem& item, const Program& program, const TextureSlot& slot,
                           TextureUse use, unsigned unit, const char* name) const {
  if (slot.texture < 0) return;
  const std::string prefix = std::string("u_") + name;
  gl_->BindTextureUnit(unit, models_->texture(item, slot, use));
  program.set(prefix, static_cast<int>(unit));
  program.set(prefix + "_set", slot.uv_set);
  program.set(prefix + "_transform", slot.transform);
}

void ModelPasses::set_cut_out(const DrawItem& item, const Program& program) const {
  const Material& material = *item.material;
  const bool mask = material.alpha_mode == AlphaMode::kMask;
  program.set("u_alpha_cutoff", mask ? material.alpha_cutoff : kBlendCutoff);
  program.set("u_alpha_factor", material.base_color.a);
  bind_map(item, program, material.base_color_map, base_color_use(item), kUnitBaseColor,
           "base_color");
}

void ModelPasses::draw_depth(const std::vector<DrawItem>& items, const glm::mat4& clip_from_world,
                             float error_m) const {
  for (const DrawItem& item : items) {
    if (!is_surface(item)) continue;
    std::vector<std::string> defines;
    if (cut_out(*item.material)) defines.emplace_back("ALPHA_MASK");
    if (item.material->base_color_map.texture >= 0) defines.emplace_back("BASE_COLOR_MAP");
    const Program& program = shaders_->get("geometry.vert", "depth_only.frag", defines);
    program.use();
    program.set("u_clip_from_model", clip_from_world * item.world_from_shape);
    if (cut_out(*item.material)) set_cut_out(item, program);
    item.draw(*gl_, error_m);
  }
}

void ModelPasses::draw_color(const std::vector<DrawItem>& items, const ShadingInput& input) const {
  gl_->Disable(GL_BLEND);
  gl_->DepthMask(GL_TRUE);
  std::vector<const DrawItem*> blended;
  for (const DrawItem& item : items) {
    if (item.material->see_through()) {
      blended.push_back(&item);
    } else {
      draw_shaded(item, input);
    }
  }
  std::stable_sort(blended.begin(), blended.end(), [&](const DrawItem* a, const DrawItem* b) {
    return view_depth(*a, *input.camera) > view_depth(*b, *input.camera);
  });
  gl_->Enable(GL_BLEND);
  gl_->BlendEquation(GL_FUNC_ADD);
  gl_->BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  gl_->DepthMask(GL_FALSE);
  for (const DrawItem* item : blended) {
    // The far side of a glass is behind its near side.
    if (item->material->double_sided) {
      gl_->Enable(GL_CULL_FACE);
      gl_->CullFace(GL_FRONT);
      draw_shaded(*item, input);
      gl_->CullFace(GL_BACK);
    }
    draw_shaded(*item, input);
  }
  gl_->DepthMask(GL_TRUE);
  gl_->Disable(GL_BLEND);
  gl_->Disable(GL_CULL_FACE);
}

void ModelPasses::draw_shaded(const DrawItem& item, const ShadingInput& input) const {
  const Material& material = *item.material;
  const Camera& camera = *input.camera;
  const Program& program = shaders_->get("model.vert", "model.frag",
                                         shading_variant(item, input, !models_->lamps().empty()));
  program.use();
  program.set("u_clip_from_world", clip_from_camera(camera) * camera.camera_from_world);
  program.set("u_world_from_shape", item.world_from_shape);
  program.set("u_normal_matrix", normal_matrix(item.world_from_shape));
  program.set("u_base_color_factor", material.base_color);
  program.set("u_alpha_cutoff", material.alpha_cutoff);
  program.set("u_exposure", input.exposure);
  bind_map(item, program, material.base_color_map, base_color_use(item), kUnitBaseColor,
           "base_color");
  if (input.occluder_depth != 0) {
    gl_->BindTextureUnit(kUnitOccluderDepth, input.occluder_depth);
    program.set("u_occluder_depth", static_cast<int>(kUnitOccluderDepth));
    program.set("u_occluder_tolerance", input.occluder_tolerance);
  }
  if (!material.unlit && !item.unlit) set_lit(item, program, input);
  gl_->FrontFace(front_face(camera, item.world_from_shape));
  // Blended double-sided items are culled side by side by the caller.
  if (!material.see_through() || !material.double_sided) {
    if (material.double_sided) {
      gl_->Disable(GL_CULL_FACE);
    } else {
      gl_->Enable(GL_CULL_FACE);
      gl_->CullFace(GL_BACK);
    }
  }
  item.draw(*gl_, allowed_error_m(item, camera, input.detail_px));
}

void ModelPasses::set_lit(const DrawItem& item, const Program& program,
                          const ShadingInput& input) const {
  const Material& material = *item.material;
  const Sun& sun = input.light->sun;
  program.set("u_metallic", material.metallic);
  program.set("u_roughness", material.roughness);
  program.set("u_emissive", material.emissive);
  program.set("u_normal_scale", material.normal_scale);
  program.set("u_occlusion_strength", material.occlusion_strength);
  bind_map(item, program, material.metallic_roughness_map, TextureUse::kNumbers,
           kUnitMetallicRoughness, "metallic_roughness");
  bind_map(item, program, material.normal_map, TextureUse::kNumbers, kUnitNormal, "normal");
  bind_map(item, program, material.occlusion_map, TextureUse::kNumbers, kUnitOcclusion,
           "occlusion");
  bind_map(item, program, material.emissive_map, TextureUse::kColor, kUnitEmissive, "emissive_map");
  program.set("u_ambient_sh", std::span<const glm::vec3>(input.light->ambient_sh));
  if (input.environment != 0) {
    gl_->BindTextureUnit(kUnitEnvironment, input.environment);
    program.set("u_environment", static_cast<int>(kUnitEnvironment));
    program.set("u_environment_from_world", input.light->environment_from_world);
    program.set("u_environment_gain", input.light->environment_gain);
    program.set("u_environment_last", static_cast<float>(input.environment_levels - 1));
  }
  program.set("u_eye", camera_position(*input.camera));
  program.set("u_to_light", glm::normalize(sun.direction_to_light));
  program.set("u_sun_radiance", sun.radiance);
  if (input.shadow != nullptr) input.shadow->bind(program, sun);
  if (!models_->lamps().empty()) set_lamps(program);
  set_layers(item, program);
}

void ModelPasses::set_layers(const DrawItem& item, const Program& program) const {
  const Material& material = *item.material;
  // (ior - 1)^2 / (ior + 1)^2; an ior of 0 means a reflectance of 1 (KHR_materials_ior).
  const float ratio = (material.ior - 1.0F) / (material.ior + 1.0F);
  program.set("u_dielectric_f0", ratio * ratio);
  program.set("u_specular", material.specular);
  program.set("u_specular_color", material.specular_color);
  bind_map(item, program, material.specular_map, TextureUse::kNumbers, kUnitSpecular,
           "specular_map");
  bind_map(item, program, material.specular_color_map, TextureUse::kColor, kUnitSpecularColor,
           "specular_color_map");
  program.set("u_transmission", material.transmission);
  bind_map(item, program, material.transmission_map, TextureUse::kNumbers, kUnitTransmission,
           "transmission_map");
  if (material.clearcoat > 0.0F) {
    program.set("u_clearcoat", material.clearcoat);
    program.set("u_clearcoat_roughness", material.clearcoat_roughness);
    program.set("u_clearcoat_normal_scale", material.clearcoat_normal_scale);
    bind_map(item, program, material.clearcoat_map, TextureUse::kNumbers, kUnitClearcoat,
             "clearcoat_map");
    bind_map(item, program, material.clearcoat_roughness_map, TextureUse::kNumbers,
             kUnitClearcoatRoughness, "clearcoat_roughness_map");
    bind_map(item, program, material.clearcoat_normal_map, TextureUse::kNumbers,
             kUnitClearcoatNormal, "clearcoat_normal_map");
  }
  if (material.sheen_color != glm::vec3(0.0F)) {
    program.set("u_sheen_color", material.sheen_color);
    program.set("u_sheen_roughness", material.sheen_roughness);
    bind_map(item, program, material.sheen_color_map, TextureUse::kColor, kUnitSheenColor,
             "sheen_color_map");
    bind_map(item, program, material.sheen_roughness_map, TextureUse::kNumbers, kUnitSheenRoughness,
             "sheen_roughness_map");
  }
}

void ModelPasses::set_lamps(const Program& program) const {
  std::vector<glm::vec4> positions;
  std::vector<glm::vec4> intensities;
  std::vector<glm::vec4> axes;
  std::vector<glm::vec4> inner;
  for (const Lamp& lamp : models_->lamps()) {
    positions.push_back(lamp.position);
    intensities.push_back(lamp.intensity);
    axes.push_back(lamp.axis);
    inner.emplace_back(lamp.inner_cosine);
  }
  program.set("u_lamp_count", static_cast<int>(positions.size()));
  program.set("u_lamp_position", std::span<const glm::vec4>(positions));
  program.set("u_lamp_intensity", std::span<const glm::vec4>(intensities));
  program.set("u_lamp_axis", std::span<const glm::vec4>(axes));
  program.set("u_lamp_inner", std::span<const glm::vec4>(inner));
}

void ModelPasses::draw_geometry(const std::vector<DrawItem>& items,
                                const ShadingInput& input) const {
  const Camera& camera = *input.camera;
  for (const DrawItem& item : items) {
    std::vector<std::string> defines;
    if (cut_out(*item.material)) defines.emplace_back("ALPHA_MASK");
    if (item.material->base_color_map.texture >= 0) defines.emplace_back("BASE_COLOR_MAP");
    if (input.occluder_depth != 0) defines.emplace_back("OCCLUDER_DEPTH");
    const Program& program = shaders_->get("geometry.vert", "geometry.frag", defines);
    program.use();
    program.set("u_clip_from_model",
                clip_from_camera(camera) * camera.camera_from_world * item.world_from_shape);
    program.set("u_label", 0);
    if (cut_out(*item.material)) set_cut_out(item, program);
    if (input.occluder_depth != 0) {
      gl_->BindTextureUnit(kUnitOccluderDepth, input.occluder_depth);
      program.set("u_occluder_depth", static_cast<int>(kUnitOccluderDepth));
      program.set("u_occluder_tolerance", input.occluder_tolerance);
    }
    gl_->FrontFace(front_face(camera, item.world_from_shape));
    if (item.material->double_sided) {
      gl_->Disable(GL_CULL_FACE);
    } else {
      gl_->Enable(GL_CULL_FACE);
      gl_->CullFace(GL_BACK);
    }
    item.draw(*gl_, allowed_error_m(item, camera, input.detail_px));
  }
  gl_->Disable(GL_CULL_FACE);
}

void ModelPasses::draw_heights(const std::vector<DrawItem>& items, const glm::mat4& clip_from_world,
                               const glm::vec4& plane, float error_m) const {
  const Program& program = shaders_->get("heights.vert", "heights.frag");
  program.use();
  program.set("u_clip_from_world", clip_from_world);
  program.set("u_plane", plane);
  for (const DrawItem& item : items) {
    if (!is_surface(item)) continue;
    program.set("u_world_from_shape", item.world_from_shape);
    item.draw(*gl_, error_m);
  }
}

}  // namespace planecast::render
