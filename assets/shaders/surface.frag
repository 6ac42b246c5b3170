in vec3 v_world;
in vec3 v_normal;
in vec2 v_uv;
in vec3 v_ambient;

uniform sampler2D u_base_color;
uniform vec3 u_color_factor;
uniform float u_roughness;
uniform float u_exposure;
uniform vec3 u_eye;
uniform vec3 u_to_light;
uniform vec3 u_sun_radiance;

#include "color.glsl"
#ifdef SHADOWS
#include "shadow.glsl"
#endif

out vec4 o_color;

const float kDielectricReflectance = 0.04;

// Cook-Torrance with GGX, the geometry and Fresnel terms folded into one fit (Karis, "Physically Based
// Shading on Mobile", SIGGRAPH 2015 course "Moving Mobile Graphics"); times pi, as the sun is given as
// irradiance / pi.
float small_specular(vec3 normal, vec3 to_eye) {
  vec3 middle = normalize(u_to_light + to_eye);
  float a2 = u_roughness * u_roughness * u_roughness * u_roughness;
  float n_dot_h = max(dot(normal, middle), 0.0);
  float l_dot_h = max(dot(u_to_light, middle), 0.0);
  float d = n_dot_h * n_dot_h * (a2 - 1.0) + 1.0;
  return kDielectricReflectance * a2 / (4.0 * d * d * max(0.1, l_dot_h * l_dot_h) * (u_roughness + 0.5));
}

#ifdef TEXTURE
// Mip levels follow the longer axis of a pixel's footprint, which blurs what is seen at a slant; up to
// a ratio of 2.25 they follow the mean of both instead. llvmpipe's own anisotropic filter costs five
// times the whole pass, whatever its level.
vec3 base_color() {
  vec2 size = vec2(textureSize(u_base_color, 0));
  vec2 across = dFdx(v_uv) * size;
  vec2 down = dFdy(v_uv) * size;
  float a = dot(across, across);
  float d = dot(down, down);
  float squared_ratio = max(a, d) / max(min(a, d), 1e-12);
  float bias = -0.25 * log2(clamp(squared_ratio, 1.0, 5.0));
  return texture(u_base_color, v_uv, bias).rgb;
}
#endif

void main() {
  vec3 albedo = u_color_factor;
#ifdef TEXTURE
  albedo *= base_color();
#endif
  vec3 normal = normalize(v_normal);
  vec3 color = albedo * v_ambient;
#ifdef SUN
  float n_dot_l = max(dot(normal, u_to_light), 0.0);
  float arrives = n_dot_l;
#ifdef SHADOWS
  arrives *= sun_visibility(v_world, normal, n_dot_l);
#endif
  color += (albedo + small_specular(normal, normalize(u_eye - v_world))) * u_sun_radiance * arrives;
#endif
  o_color = vec4(srgb_encode(color * u_exposure), 1.0);
}
