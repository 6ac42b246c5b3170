// glTF 2.0 metallic-roughness shading. Output: encoded to sRGB, then premultiplied.
in vec3 v_world;
in vec3 v_normal;
in vec4 v_tangent;
in vec4 v_uv;
in vec4 v_color;

uniform vec4 u_base_color_factor;
uniform float u_alpha_cutoff;
uniform float u_exposure;
uniform float u_metallic;
uniform float u_roughness;
uniform vec3 u_emissive;
uniform float u_normal_scale;
uniform float u_occlusion_strength;
uniform vec3 u_eye;
uniform vec3 u_to_light;
uniform vec3 u_sun_radiance;

uniform sampler2D u_base_color;
uniform int u_base_color_set;
uniform mat3 u_base_color_transform;
uniform sampler2D u_metallic_roughness;
uniform int u_metallic_roughness_set;
uniform mat3 u_metallic_roughness_transform;
uniform sampler2D u_normal;
uniform int u_normal_set;
uniform mat3 u_normal_transform;
uniform sampler2D u_occlusion;
uniform int u_occlusion_set;
uniform mat3 u_occlusion_transform;
uniform sampler2D u_emissive_map;
uniform int u_emissive_map_set;
uniform mat3 u_emissive_map_transform;

#include "color.glsl"
#include "stretched.glsl"
#include "texture_slot.glsl"
#ifdef OCCLUDER_DEPTH
#include "occluder_depth.glsl"
#endif
#ifndef UNLIT
#include "ambient.glsl"
#include "brdf.glsl"
#endif
#ifdef SHADOWS
#include "shadow.glsl"
#endif

out vec4 o_color;

vec4 base_color() {
  vec4 color = u_base_color_factor * v_color;
#ifdef BASE_COLOR_MAP
  color *= sample_stretched(u_base_color, slot_uv(v_uv, u_base_color_set, u_base_color_transform));
#endif
  return color;
}

#ifndef UNLIT
vec3 shading_normal(vec3 geometric) {
#ifdef NORMAL_MAP
  vec3 tangent = v_tangent.xyz - geometric * dot(geometric, v_tangent.xyz);
  float length2 = dot(tangent, tangent);
  if (length2 < 1e-12) return geometric;
  tangent *= inversesqrt(length2) * (gl_FrontFacing ? 1.0 : -1.0);
  vec3 bitangent = cross(geometric, tangent) * v_tangent.w;
  vec3 local = texture(u_normal, slot_uv(v_uv, u_normal_set, u_normal_transform)).xyz * 2.0 - 1.0;
  local.xy *= u_normal_scale;
  return normalize(mat3(tangent, bitangent, geometric) * local);
#else
  return geometric;
#endif
}

vec3 shade(vec3 albedo) {
  vec3 geometric = normalize(v_normal) * (gl_FrontFacing ? 1.0 : -1.0);
  vec3 n = shading_normal(geometric);
  vec3 v = normalize(u_eye - v_world);
  float metallic = u_metallic;
  float roughness = u_roughness;
#ifdef METALLIC_ROUGHNESS_MAP
  vec4 mr = texture(u_metallic_roughness,
                    slot_uv(v_uv, u_metallic_roughness_set, u_metallic_roughness_transform));
  metallic *= mr.b;
  roughness *= mr.g;
#endif
  roughness = clamp(roughness, 0.045, 1.0);
  float alpha = roughness * roughness;
  vec3 f0 = mix(vec3(0.04), albedo, metallic);
  vec3 diffuse = albedo * (1.0 - metallic);
  float n_dot_v = max(dot(n, v), 1e-3);

  // Surroundings. The reflected lobe is as blurred as GGX is wide: band l fades with alpha, so that a
  // mirror sees the harmonics themselves and roughness 1 about the cosine lobe.
  vec2 ab = split_sum(roughness, n_dot_v);
  vec3 single = f0 * ab.x + ab.y;
  // What single scattering loses comes back after more bounces (Fdez-Aguera 2019, simplified).
  vec3 specular = single * (1.0 + f0 * (1.0 / max(ab.x + ab.y, 1e-3) - 1.0));
  vec3 lobe = vec3(1.0, exp(-0.45 * alpha), exp(-1.4 * alpha));
  vec3 ambient = diffuse * (1.0 - specular) * diffuse_ambient(n) +
                 specular * evaluate_sh(reflect(-v, n), lobe);
#ifdef OCCLUSION_MAP
  float open = texture(u_occlusion, slot_uv(v_uv, u_occlusion_set, u_occlusion_transform)).r;
  ambient *= 1.0 + u_occlusion_strength * (open - 1.0);
#endif
  vec3 color = ambient;

#ifdef SUN
  float n_dot_l = dot(n, u_to_light);
  if (n_dot_l > 0.0) {
    vec3 h = normalize(u_to_light + v);
    vec3 f = fresnel(f0, max(dot(v, h), 0.0));
    vec3 reflected = f * ggx_times_pi(alpha, n_dot_l, n_dot_v, max(dot(n, h), 0.0));
    float arrives = n_dot_l;
#ifdef SHADOWS
    arrives *= sun_visibility(v_world, geometric, max(dot(geometric, u_to_light), 0.0));
#endif
    color += (diffuse * (1.0 - f) + reflected) * u_sun_radiance * arrives;
  }
#endif

  vec3 emissive = u_emissive;
#ifdef EMISSIVE_MAP
  emissive *= texture(u_emissive_map, slot_uv(v_uv, u_emissive_map_set, u_emissive_map_transform)).rgb;
#endif
  return color + emissive;
}
#endif

void main() {
  vec4 base = base_color();
  float alpha = 1.0;
#ifdef ALPHA_BLEND
  alpha = clamp(base.a, 0.0, 1.0);
#endif
#ifdef ALPHA_MASK
#ifdef SAMPLE_COVERAGE
  // The edge of a cut-out covers as many of the four samples as the texture's slope says.
  float covered = (base.a - u_alpha_cutoff) / max(fwidth(base.a), 1e-4) + 0.5;
  int samples = int(clamp(covered, 0.0, 1.0) * 4.0 + 0.5);
  if (samples == 0) discard;
  gl_SampleMask[0] = (1 << samples) - 1;
#else
  if (base.a < u_alpha_cutoff) discard;
#endif
#endif
#ifdef OCCLUDER_DEPTH
  alpha *= depth_visibility();
  if (alpha <= 0.0) discard;
#endif
#ifdef UNLIT
  vec3 color = base.rgb;
#else
  vec3 color = shade(base.rgb);
#endif
  o_color = vec4(srgb_encode(color * u_exposure) * alpha, alpha);
}
