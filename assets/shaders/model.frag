// glTF 2.0 metallic-roughness shading with its layers. Output: encoded to sRGB, then premultiplied.
in vec3 v_world;
in vec3 v_normal;
in vec4 v_tangent;
in vec4 v_uv;
in vec4 v_color;

uniform float u_alpha_cutoff;
uniform float u_exposure;
uniform vec3 u_eye;
uniform vec3 u_to_light;
uniform vec3 u_sun_radiance;

#include "color.glsl"
#ifdef TONE_NEUTRAL
#include "tone.glsl"
#endif
#include "stretched.glsl"
#include "texture_slot.glsl"
#include "model_maps.glsl"
#ifdef OCCLUDER_DEPTH
#include "occluder_depth.glsl"
#endif
#ifndef UNLIT
#include "model_layers.glsl"
#include "ambient.glsl"
#include "brdf.glsl"
#ifdef SHEEN
#include "sheen.glsl"
#endif
#ifdef LAMPS
#include "lamps.glsl"
#endif
#endif
#ifdef SHADOWS
#include "shadow.glsl"
#endif

out vec4 o_color;

#ifndef UNLIT
#ifdef ENVIRONMENT
uniform samplerCube u_environment;
uniform mat3 u_environment_from_world;
uniform float u_environment_last;  // level of roughness 1
uniform float u_environment_gain;

vec3 reflected_ambient(vec3 n, vec3 v, float alpha) {
  return u_environment_gain *
         textureLod(u_environment, u_environment_from_world * reflect(-v, n),
                    sqrt(alpha) * u_environment_last).rgb;
}
#else
// The reflected lobe is as blurred as GGX is wide: band l fades with alpha, so that a mirror sees the
// harmonics themselves and roughness 1 about the cosine lobe.
vec3 reflected_ambient(vec3 n, vec3 v, float alpha) {
  return evaluate_sh(reflect(-v, n), vec3(1.0, exp(-0.45 * alpha), exp(-1.4 * alpha)));
}
#endif

struct Surface {
  vec3 n;
  vec3 v;
  vec3 diffuse;
  vec3 f0;
  float f90;
  float alpha;
  float n_dot_v;
#ifdef CLEARCOAT
  vec3 coat_n;
  vec2 coat;  // strength and roughness
#endif
#ifdef SHEEN
  vec4 sheen;  // colour and roughness
#endif
};

// The layers from top to bottom: coat, sheen, base; each leaves to the next what it does not reflect.
vec3 layered(Surface s, vec3 base, vec3 sheen_light, float sheen_share, vec3 coat_light, float coat_v) {
  vec3 color = base;
#ifdef SHEEN
  color = sheen_light + color * (1.0 - max(max(s.sheen.r, s.sheen.g), s.sheen.b) * sheen_share);
#endif
#ifdef CLEARCOAT
  float reflected = s.coat.x * fresnel(vec3(0.04), 1.0, coat_v).r;
  color = color * (1.0 - reflected) + coat_light;
#endif
  return color;
}

vec3 ambient_light(Surface s) {
  vec2 ab = split_sum(sqrt(s.alpha), s.n_dot_v);
  vec3 single = s.f0 * ab.x + s.f90 * ab.y;
  // What single scattering loses comes back after more bounces (Fdez-Aguera 2019, simplified).
  vec3 specular = single * (1.0 + s.f0 * (1.0 / max(ab.x + ab.y, 1e-3) - 1.0));
  vec3 base = s.diffuse * (1.0 - specular) * diffuse_ambient(s.n) +
              specular * reflected_ambient(s.n, s.v, s.alpha);
  vec3 sheen_light = vec3(0.0);
  float sheen_share = 0.0;
  vec3 coat_light = vec3(0.0);
  float coat_v = 1.0;
#ifdef SHEEN
  sheen_share = sheen_albedo(s.sheen.a, s.n_dot_v);
  sheen_light = s.sheen.rgb * sheen_share * diffuse_ambient(s.n);
#endif
#ifdef CLEARCOAT
  coat_v = max(dot(s.coat_n, s.v), 1e-3);
  vec2 coat_ab = split_sum(s.coat.y, coat_v);
  coat_light = s.coat.x * (0.04 * coat_ab.x + coat_ab.y) *
               reflected_ambient(s.coat_n, s.v, s.coat.y * s.coat.y);
#endif
  return layered(s, base, sheen_light, sheen_share, coat_light, coat_v);
}

// Light from direction `l` with the given irradiance / pi on a facing surface.
vec3 direct_light(Surface s, vec3 l, vec3 light) {
  float n_dot_l = dot(s.n, l);
  vec3 h = normalize(l + s.v);
  vec3 coat_light = vec3(0.0);
  float v_dot_h = max(dot(s.v, h), 0.0);
#ifdef CLEARCOAT
  float coat_l = max(dot(s.coat_n, l), 0.0);
  float coat_v = max(dot(s.coat_n, s.v), 1e-3);
  coat_light = s.coat.x * fresnel(vec3(0.04), 1.0, v_dot_h) * coat_l * light *
               ggx_times_pi(s.coat.y * s.coat.y, coat_l, coat_v, max(dot(s.coat_n, h), 0.0));
#endif
  if (n_dot_l <= 0.0) return coat_light;
  float n_dot_h = max(dot(s.n, h), 0.0);
  vec3 f = fresnel(s.f0, s.f90, v_dot_h);
  vec3 reflected = f * ggx_times_pi(s.alpha, n_dot_l, s.n_dot_v, n_dot_h);
  vec3 base = (s.diffuse * (1.0 - f) + reflected) * light * n_dot_l;
  vec3 sheen_light = vec3(0.0);
  float sheen_share = 0.0;
#ifdef SHEEN
  sheen_light = s.sheen.rgb * light * n_dot_l *
                sheen_times_pi(s.sheen.a, n_dot_l, s.n_dot_v, n_dot_h);
  sheen_share = max(sheen_albedo(s.sheen.a, s.n_dot_v), sheen_albedo(s.sheen.a, n_dot_l));
#endif
  return layered(s, base, sheen_light, sheen_share, coat_light, v_dot_h);
}

vec3 shade(vec3 albedo, float metallic, float roughness, float kept) {
  vec3 geometric = normalize(v_normal) * (gl_FrontFacing ? 1.0 : -1.0);
  vec4 dielectric = dielectric_reflectance();
  Surface s;
  s.n = shading_normal(geometric);
  s.v = normalize(u_eye - v_world);
  s.f0 = mix(dielectric.rgb, albedo, metallic);
  s.f90 = mix(dielectric.a, 1.0, metallic);
  s.diffuse = albedo * (1.0 - metallic) * kept;
  roughness = clamp(roughness, 0.045, 1.0);
  s.alpha = roughness * roughness;
  s.n_dot_v = max(dot(s.n, s.v), 1e-3);
#ifdef CLEARCOAT
  s.coat_n = clearcoat_normal(geometric);
  s.coat = clearcoat();
#endif
#ifdef SHEEN
  s.sheen = sheen();
#endif

  vec3 color = ambient_light(s) * ambient_openness();
#ifdef SUN
  float facing = dot(s.n, u_to_light);
#ifdef CLEARCOAT
  facing = max(facing, dot(s.coat_n, u_to_light));
#endif
  if (facing > 0.0) {
    float arrives = 1.0;
#ifdef SHADOWS
    arrives = sun_visibility(v_world, geometric, max(dot(geometric, u_to_light), 0.0));
#endif
    color += direct_light(s, u_to_light, u_sun_radiance * arrives);
  }
#endif
#ifdef LAMPS
  for (int i = 0; i < u_lamp_count; ++i) {
    vec3 to_lamp;
    vec3 light = lamp_light(i, v_world, to_lamp);
    color += direct_light(s, to_lamp, light);
  }
#endif
  vec3 emissive = emitted();
#ifdef CLEARCOAT
  emissive *= 1.0 - s.coat.x * fresnel(vec3(0.04), 1.0, max(dot(s.coat_n, s.v), 0.0)).r;
#endif
  return color + emissive;
}
#endif

vec3 shown(vec3 color) {
  color *= u_exposure;
#ifdef TONE_NEUTRAL
  color = tone_neutral(color);
#endif
  return srgb_encode(color);
}

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
  float covers = 1.0;
#ifdef UNLIT
  vec3 color = shown(base.rgb);
#else
  vec2 mr = metallic_roughness();
  float kept = 1.0;
#ifdef TRANSMISSION
  kept = 1.0 - transmitted_share() * (1.0 - mr.x);
#endif
  vec3 color = shown(shade(base.rgb, mr.x, mr.y, kept));
#ifdef TRANSMISSION
  // What is behind shows through, darkened by the mean of the tint; a reflection covers it.
  float tint = dot(base.rgb, vec3(1.0 / 3.0));
  covers = max(1.0 - (1.0 - kept) * tint, max(color.r, max(color.g, color.b)));
#endif
#endif
  o_color = vec4(color * alpha, covers * alpha);
}
