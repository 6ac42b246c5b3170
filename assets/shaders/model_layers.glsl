// The layers that extensions add to a glTF material: what their factors and textures say.
#ifdef SPECULAR
uniform float u_specular;
uniform vec3 u_specular_color;
uniform float u_dielectric_f0;
uniform sampler2D u_specular_map;
uniform int u_specular_map_set;
uniform mat3 u_specular_map_transform;
uniform sampler2D u_specular_color_map;
uniform int u_specular_color_map_set;
uniform mat3 u_specular_color_map_transform;

// Reflectance of the dielectric part, facing (rgb) and grazing (a): KHR_materials_ior, _specular.
vec4 dielectric_reflectance() {
  float strength = u_specular;
  vec3 color = u_specular_color;
#ifdef SPECULAR_MAP
  strength *= texture(u_specular_map, slot_uv(v_uv, u_specular_map_set, u_specular_map_transform)).a;
#endif
#ifdef SPECULAR_COLOR_MAP
  color *= texture(u_specular_color_map,
                   slot_uv(v_uv, u_specular_color_map_set, u_specular_color_map_transform)).rgb;
#endif
  return vec4(min(u_dielectric_f0 * color, vec3(1.0)) * strength, strength);
}
#else
vec4 dielectric_reflectance() { return vec4(vec3(0.04), 1.0); }
#endif

#ifdef TRANSMISSION
uniform float u_transmission;
uniform sampler2D u_transmission_map;
uniform int u_transmission_map_set;
uniform mat3 u_transmission_map_transform;

float transmitted_share() {
  float share = u_transmission;
#ifdef TRANSMISSION_MAP
  share *= texture(u_transmission_map,
                   slot_uv(v_uv, u_transmission_map_set, u_transmission_map_transform)).r;
#endif
  return share;
}
#endif

#ifdef CLEARCOAT
uniform float u_clearcoat;
uniform float u_clearcoat_roughness;
uniform float u_clearcoat_normal_scale;
uniform sampler2D u_clearcoat_map;
uniform int u_clearcoat_map_set;
uniform mat3 u_clearcoat_map_transform;
uniform sampler2D u_clearcoat_roughness_map;
uniform int u_clearcoat_roughness_map_set;
uniform mat3 u_clearcoat_roughness_map_transform;
uniform sampler2D u_clearcoat_normal_map;
uniform int u_clearcoat_normal_map_set;
uniform mat3 u_clearcoat_normal_map_transform;

// Strength and roughness.
vec2 clearcoat() {
  vec2 coat = vec2(u_clearcoat, u_clearcoat_roughness);
#ifdef CLEARCOAT_MAP
  coat.x *= texture(u_clearcoat_map, slot_uv(v_uv, u_clearcoat_map_set, u_clearcoat_map_transform)).r;
#endif
#ifdef CLEARCOAT_ROUGHNESS_MAP
  coat.y *= texture(u_clearcoat_roughness_map,
                    slot_uv(v_uv, u_clearcoat_roughness_map_set, u_clearcoat_roughness_map_transform)).g;
#endif
  return vec2(coat.x, clamp(coat.y, 0.045, 1.0));
}

vec3 clearcoat_normal(vec3 geometric) {
#ifdef CLEARCOAT_NORMAL_MAP
  vec3 texel = texture(u_clearcoat_normal_map,
                       slot_uv(v_uv, u_clearcoat_normal_map_set, u_clearcoat_normal_map_transform)).xyz;
  return bent_normal(geometric, texel, u_clearcoat_normal_scale);
#else
  return geometric;
#endif
}
#endif

#ifdef SHEEN
uniform vec3 u_sheen_color;
uniform float u_sheen_roughness;
uniform sampler2D u_sheen_color_map;
uniform int u_sheen_color_map_set;
uniform mat3 u_sheen_color_map_transform;
uniform sampler2D u_sheen_roughness_map;
uniform int u_sheen_roughness_map_set;
uniform mat3 u_sheen_roughness_map_transform;

// Colour and roughness.
vec4 sheen() {
  vec4 value = vec4(u_sheen_color, u_sheen_roughness);
#ifdef SHEEN_COLOR_MAP
  value.rgb *= texture(u_sheen_color_map,
                       slot_uv(v_uv, u_sheen_color_map_set, u_sheen_color_map_transform)).rgb;
#endif
#ifdef SHEEN_ROUGHNESS_MAP
  value.a *= texture(u_sheen_roughness_map,
                     slot_uv(v_uv, u_sheen_roughness_map_set, u_sheen_roughness_map_transform)).a;
#endif
  return vec4(value.rgb, clamp(value.a, 0.1, 1.0));
}
#endif
