// The shadow that objects throw on a real plane: black, with the alpha that darkens the video as much
// as the light lost on the plane.
in vec2 v_plane;
in vec3 v_world;

#ifdef BAKED
uniform sampler2D u_baked;  // shares lost of the surroundings' light and the sun's, inside
uniform vec2 u_baked_min;
uniform vec2 u_baked_max;
#endif
uniform sampler2D u_mask;  // distance to the polygon's edge, metres
uniform vec2 u_mask_min;
uniform vec2 u_mask_max;
uniform float u_edge_softness_m;
uniform float u_sun_share;  // of the plane's light, when nothing is in the way
uniform float u_strength;

#ifdef CONTACT
uniform sampler2D u_contact;
uniform float u_contact_strength;
uniform vec2 u_contact_min;
uniform vec2 u_contact_max;
#endif
#ifdef SUN
uniform sampler2D u_penumbra;
uniform mat4 u_shadow_from_world;
uniform float u_penumbra_texel_m;
uniform float u_penumbra_extent_m;
uniform float u_light_tangent;
uniform float u_farthest_gap_m;
uniform float u_smallest_radius_m;
#endif
#ifdef OCCLUDER_DEPTH
#include "occluder_depth.glsl"
#endif

out vec4 o_color;

#ifdef SUN
const int kTaps = 12;

float level_of(float width_m) { return log2(max(width_m / u_penumbra_texel_m, 1.0)); }

// Width of the light as seen from here through the nearest blockers, then the share of it they hide.
float sun_hidden() {
  vec2 at = 0.5 * (u_shadow_from_world * vec4(v_world, 1.0)).xy + 0.5;
  float radius = max(u_light_tangent * u_farthest_gap_m, u_smallest_radius_m);
  vec2 found = textureLod(u_penumbra, at, level_of(2.0 * radius)).rg;
  // A loop of no turns is what lets a software rasteriser skip the pixels that nothing shades.
  int taps = found.r > 1e-3 ? kTaps : 0;
  radius = max(u_light_tangent * found.g / max(found.r, 1e-6), u_smallest_radius_m);
  for (int i = 0; i < min(taps, 1); ++i) {
    found = textureLod(u_penumbra, at, level_of(2.0 * radius)).rg;
    if (found.r > 1e-3) radius = max(u_light_tangent * found.g / found.r, u_smallest_radius_m);
  }
  float sum = 0.0;
  float level = level_of(0.9 * radius);
  for (int i = 0; i < taps; ++i) {
    // Sunflower points fill a disc evenly.
    float r = sqrt((float(i) + 0.5) / float(kTaps)) * radius / u_penumbra_extent_m;
    float angle = 2.3999632 * float(i);
    sum += textureLod(u_penumbra, at + r * vec2(cos(angle), sin(angle)), level).r;
  }
  return sum / float(kTaps);
}
#endif

// Shares of the light that are hidden, surroundings' and sun's, and how far inside the polygon.
vec3 hidden_and_inside() {
  float edge = texture(u_mask, (v_plane - u_mask_min) / (u_mask_max - u_mask_min)).r;
  vec3 found = vec3(0.0, 0.0, smoothstep(0.0, max(u_edge_softness_m, 1e-6), edge));
#ifdef CONTACT
  vec2 share = (v_plane - u_contact_min) / (u_contact_max - u_contact_min);
  if (all(greaterThan(share, vec2(0.0))) && all(lessThan(share, vec2(1.0)))) {
    found.x = u_contact_strength * texture(u_contact, share).r;
  }
#endif
#ifdef SUN
  found.y = sun_hidden();
#endif
  return found;
}

void main() {
#ifdef BAKED
  // Seen at a slant, the level for the longer side of the footprint would blur across the shorter one.
  vec3 found = texture(u_baked, (v_plane - u_baked_min) / (u_baked_max - u_baked_min), -1.0).rgb;
#else
  vec3 found = hidden_and_inside();
#endif
#ifdef BAKE
  o_color = vec4(found, 1.0);
#else
  float lost = (1.0 - u_sun_share) * found.x + u_sun_share * found.y;
  // The video is encoded: multiplying light by k multiplies it by about k^(1 / 2.2).
  float alpha = 1.0 - pow(clamp(1.0 - u_strength * lost, 0.0, 1.0), 1.0 / 2.2);
  alpha *= found.z;
#ifdef OCCLUDER_DEPTH
  alpha *= depth_visibility();
#endif
  o_color = vec4(0.0, 0.0, 0.0, alpha);
#endif
}
