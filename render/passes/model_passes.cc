#include "render/passes/model_passes.h"

#include <algorithm>
#include <string>

#include "render/passes/texture_units.h"
#include "render/passes/view.h"

namespace planecast::render {
namespace {

/// Blended surfaces have no depth or shadow of their own below half opacity.
constexpr float kBlendCutoff = 0.5F;

bool cut_out(const Material& material) { return material.alpha_mode != AlphaMode::kOpaque; }

/// Inverse transpose up to a factor, defined for singular matrices too.
glm::mat3 normal_matrix(const glm::mat4& matrix) {
  const glm::mat3 m(matrix);
  const glm::mat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  return glm::determinant(m) < 0.0F ? -cofactors : cofactors;
}

float view_depth(const DrawItem& item, const Camera& camera) {
  const glm::vec4 center(0.5F * (item.box.min + item.box.max), 1.0F);
  return (camera.camera_from_world * item.world_from_shape * center).z;
}

std::vector<std::string> shading_variant(const Material& material, const ShadingInput& input) {
  std::vector<std::string> defines;
  const auto when = [&defines](bool condition, const char* name) {
    if (condition) defines.emplace_back(name);
  };
  const bool sun = input.light->sun.radiance != glm::vec3(0.0F);
  when(material.unlit, "UNLIT");
  when(material.base_color_map.texture >= 0, "BASE_COLOR_MAP");
  when(material.alpha_mode == AlphaMode::kMask, "ALPHA_MASK");
  when(material.alpha_mode == AlphaMode::kMask && input.multisampled, "SAMPLE_COVERAGE");
  when(material.alpha_mode == AlphaMode::kBlend, "ALPHA_BLEND");
  when(input.occluder_depth != 0, "OCCLUDER_DEPTH");
  if (material.unlit) return defines;
  when(material.metallic_roughness_map.texture >= 0, "METALLIC_ROUGHNESS_MAP");
  when(material.normal_map.texture >= 0, "NORMAL_MAP");
  when(material.occlusion_map.texture >= 0, "OCCLUSION_MAP");
  when(material.emissive_map.texture >= 0, "EMISSIVE_MAP");
  when(sun, "SUN");
  when(sun && input.shadow != nullptr, "SHADOWS");
  return defines;
}

}  // namespace

void ModelPasses::bind_map(const DrawItem& item, const Program& program, const TextureSlot& slot,
                           bool srgb, unsigned unit, const char* name) const {
  if (slot.texture < 0) return;
  const std::string prefix = std::string("u_") + name;
  gl_->BindTextureUnit(unit, models_->texture(item, slot, srgb));
  program.set(prefix, static_cast<int>(unit));
  program.set(prefix + "_set", slot.uv_set);
  program.set(prefix + "_transform", slot.transform);
}

void ModelPasses::set_cut_out(const DrawItem& item, const Program& program) const {
  const Material& material = *item.material;
  const bool mask = material.alpha_mode == AlphaMode::kMask;
  program.set("u_alpha_cutoff", mask ? material.alpha_cutoff : kBlendCutoff);
  program.set("u_alpha_factor", material.base_color.a);
  bind_map(item, program, material.base_color_map, true, kUnitBaseColor, "base_color");
}

void ModelPasses::draw_depth(const std::vector<DrawItem>& items,
                             const glm::mat4& clip_from_world) const {
  for (const DrawItem& item : items) {
    std::vector<std::string> defines;
    if (cut_out(*item.material)) defines.emplace_back("ALPHA_MASK");
    if (item.material->base_color_map.texture >= 0) defines.emplace_back("BASE_COLOR_MAP");
    const Program& program = shaders_->get("geometry.vert", "depth_only.frag", defines);
    program.use();
    program.set("u_clip_from_model", clip_from_world * item.world_from_shape);
    if (cut_out(*item.material)) set_cut_out(item, program);
    item.draw(*gl_);
  }
}

void ModelPasses::draw_color(const std::vector<DrawItem>& items, const ShadingInput& input) const {
  gl_->Disable(GL_BLEND);
  gl_->DepthMask(GL_TRUE);
  std::vector<const DrawItem*> blended;
  for (const DrawItem& item : items) {
    if (item.material->alpha_mode == AlphaMode::kBlend) {
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
  const Program& program =
      shaders_->get("model.vert", "model.frag", shading_variant(material, input));
  program.use();
  program.set("u_clip_from_world", clip_from_camera(camera) * camera.camera_from_world);
  program.set("u_world_from_shape", item.world_from_shape);
  program.set("u_normal_matrix", normal_matrix(item.world_from_shape));
  program.set("u_base_color_factor", material.base_color);
  program.set("u_alpha_cutoff", material.alpha_cutoff);
  program.set("u_exposure", input.exposure);
  bind_map(item, program, material.base_color_map, true, kUnitBaseColor, "base_color");
  if (input.occluder_depth != 0) {
    gl_->BindTextureUnit(kUnitOccluderDepth, input.occluder_depth);
    program.set("u_occluder_depth", static_cast<int>(kUnitOccluderDepth));
    program.set("u_occluder_tolerance", input.occluder_tolerance);
  }
  if (!material.unlit) {
    const Sun& sun = input.light->sun;
    program.set("u_metallic", material.metallic);
    program.set("u_roughness", material.roughness);
    program.set("u_emissive", material.emissive);
    program.set("u_normal_scale", material.normal_scale);
    program.set("u_occlusion_strength", material.occlusion_strength);
    bind_map(item, program, material.metallic_roughness_map, false, kUnitMetallicRoughness,
             "metallic_roughness");
    bind_map(item, program, material.normal_map, false, kUnitNormal, "normal");
    bind_map(item, program, material.occlusion_map, false, kUnitOcclusion, "occlusion");
    bind_map(item, program, material.emissive_map, true, kUnitEmissive, "emissive_map");
    program.set("u_ambient_sh", std::span<const glm::vec3>(input.light->ambient_sh));
    program.set("u_eye", camera_position(camera));
    program.set("u_to_light", glm::normalize(sun.direction_to_light));
    program.set("u_sun_radiance", sun.radiance);
    if (input.shadow != nullptr) input.shadow->bind(program, sun);
  }
  gl_->FrontFace(front_face(camera, item.world_from_shape));
  // Blended double-sided items are culled side by side by the caller.
  if (material.alpha_mode != AlphaMode::kBlend || !material.double_sided) {
    if (material.double_sided) {
      gl_->Disable(GL_CULL_FACE);
    } else {
      gl_->Enable(GL_CULL_FACE);
      gl_->CullFace(GL_BACK);
    }
  }
  item.draw(*gl_);
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
    item.draw(*gl_);
  }
  gl_->Disable(GL_CULL_FACE);
}

void ModelPasses::draw_heights(const std::vector<DrawItem>& items, const glm::mat4& clip_from_world,
                               const glm::vec4& plane) const {
  const Program& program = shaders_->get("heights.vert", "heights.frag");
  program.use();
  program.set("u_clip_from_world", clip_from_world);
  program.set("u_plane", plane);
  for (const DrawItem& item : items) {
    program.set("u_world_from_shape", item.world_from_shape);
    item.draw(*gl_);
  }
}

}  // namespace planecast::render
