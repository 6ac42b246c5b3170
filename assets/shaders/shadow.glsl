// The sun's shadow map; set by ShadowMap::bind.
uniform sampler2DShadow u_shadow_map;
uniform sampler2D u_shadow_depth;
uniform mat4 u_shadow_from_world;
uniform float u_shadow_extent_m;
uniform float u_shadow_depth_m;
uniform float u_shadow_texel_m;
uniform float u_shadow_radius_m;

vec3 shadow_coordinates(vec3 world) {
  vec3 clip = (u_shadow_from_world * vec4(world, 1.0)).xyz;
  return vec3(0.5 * clip.xy + 0.5, clip.z);
}

// Share of the sun that arrives, for a surface that is a caster itself: the point is moved off the
// surface by about the filter's width, so that it does not shade itself.
float sun_visibility(vec3 world, vec3 normal, float n_dot_l) {
  float reach = 1.5 * u_shadow_texel_m + u_shadow_radius_m;
  float slope = sqrt(max(0.0, 1.0 - n_dot_l * n_dot_l));
  vec3 at = shadow_coordinates(world + normal * reach * (0.3 + slope));
  at.z -= 0.5 * u_shadow_texel_m / u_shadow_depth_m;
  // Four bilinear comparisons, turned so that neither rows nor columns of texels coincide.
  vec2 step = vec2(0.9, 0.35) * (u_shadow_radius_m / u_shadow_extent_m);
  float sum = texture(u_shadow_map, vec3(at.xy + step, at.z));
  sum += texture(u_shadow_map, vec3(at.xy - step, at.z));
  sum += texture(u_shadow_map, vec3(at.xy + vec2(-step.y, step.x), at.z));
  sum += texture(u_shadow_map, vec3(at.xy + vec2(step.y, -step.x), at.z));
  return 0.25 * sum;
}
