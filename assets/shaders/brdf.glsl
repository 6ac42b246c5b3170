// Metallic-roughness BRDF of glTF 2.0, appendix B: GGX, height-correlated Smith, Schlick.

// Distribution times visibility, times pi (the sun is given as irradiance / pi).
float ggx_times_pi(float alpha, float n_dot_l, float n_dot_v, float n_dot_h) {
  float a2 = alpha * alpha;
  float d = n_dot_h * n_dot_h * (a2 - 1.0) + 1.0;
  float v = n_dot_l * sqrt(n_dot_v * n_dot_v * (1.0 - a2) + a2) +
            n_dot_v * sqrt(n_dot_l * n_dot_l * (1.0 - a2) + a2);
  return 0.5 * a2 / (d * d * max(v, 1e-5));
}

vec3 fresnel(vec3 f0, float f90, float v_dot_h) {
  float base = 1.0 - v_dot_h;
  float base2 = base * base;
  return f0 + (f90 - f0) * base2 * base2 * base;
}

// Scale and bias of f0 for light from everywhere (Karis, "Physically Based Shading on Mobile", 2014,
// after Lazarov 2013).
vec2 split_sum(float roughness, float n_dot_v) {
  vec4 r = roughness * vec4(-1.0, -0.0275, -0.572, 0.022) + vec4(1.0, 0.0425, 1.04, -0.04);
  float a = min(r.x * r.x, exp2(-9.28 * n_dot_v)) * r.x + r.y;
  return vec2(-1.04, 1.04) * a + r.zw;
}
