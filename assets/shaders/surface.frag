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
#include "stretched.glsl"
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

void main() {
  vec3 albedo = u_color_factor;
#ifdef TEXTURE
  albedo *= sample_stretched(u_base_color, v_uv).rgb;
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
