// The textures of a glTF material and what they make of its factors.
uniform vec4 u_base_color_factor;
uniform float u_metallic;
uniform float u_roughness;
uniform vec3 u_emissive;
uniform float u_normal_scale;
uniform float u_occlusion_strength;

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

vec4 base_color() {
  vec4 color = u_base_color_factor * v_color;
#ifdef BASE_COLOR_MAP
  color *= sample_stretched(u_base_color, slot_uv(v_uv, u_base_color_set, u_base_color_transform));
#endif
  return color;
}

vec2 metallic_roughness() {
  vec2 value = vec2(u_metallic, u_roughness);
#ifdef METALLIC_ROUGHNESS_MAP
  value *= texture(u_metallic_roughness,
                   slot_uv(v_uv, u_metallic_roughness_set, u_metallic_roughness_transform)).bg;
#endif
  return value;
}

float ambient_openness() {
#ifdef OCCLUSION_MAP
  float open = texture(u_occlusion, slot_uv(v_uv, u_occlusion_set, u_occlusion_transform)).r;
  return 1.0 + u_occlusion_strength * (open - 1.0);
#else
  return 1.0;
#endif
}

vec3 emitted() {
  vec3 emissive = u_emissive;
#ifdef EMISSIVE_MAP
  emissive *= texture(u_emissive_map, slot_uv(v_uv, u_emissive_map_set, u_emissive_map_transform)).rgb;
#endif
  return emissive;
}

// A normal map's value in the frame of the surface; `geometric` where the mesh has no tangent.
vec3 bent_normal(vec3 geometric, vec3 texel, float scale) {
  vec3 tangent = v_tangent.xyz - geometric * dot(geometric, v_tangent.xyz);
  float length2 = dot(tangent, tangent);
  if (length2 < 1e-12) return geometric;
  tangent *= inversesqrt(length2) * (gl_FrontFacing ? 1.0 : -1.0);
  vec3 bitangent = cross(geometric, tangent) * v_tangent.w;
  vec3 local = texel * 2.0 - 1.0;
  local.xy *= scale;
  return normalize(mat3(tangent, bitangent, geometric) * local);
}

vec3 shading_normal(vec3 geometric) {
#ifdef NORMAL_MAP
  vec3 texel = texture(u_normal, slot_uv(v_uv, u_normal_set, u_normal_transform)).xyz;
  return bent_normal(geometric, texel, u_normal_scale);
#else
  return geometric;
#endif
}
