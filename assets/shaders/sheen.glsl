// Cloth: the distribution of Estevez and Kulla ("Production Friendly Microfacet Sheen BRDF", 2017) with
// the visibility of Neubelt and Pettineo (2013), as KHR_materials_sheen has it.

// Times pi, as the sun is given as irradiance / pi.
float sheen_times_pi(float roughness, float n_dot_l, float n_dot_v, float n_dot_h) {
  float inverse_alpha = 1.0 / (roughness * roughness);
  float sine2 = max(1.0 - n_dot_h * n_dot_h, 1e-4);
  float d = (2.0 + inverse_alpha) * pow(sine2, 0.5 * inverse_alpha) * 0.5;
  return d / (4.0 * (n_dot_l + n_dot_v - n_dot_l * n_dot_v));
}

// Share of uniform light the lobe reflects: exp of a cubic in n.v and roughness^-1/2, fitted to the
// integral for roughness 0.1 to 1 (mean error 0.0045, at most 0.041).
float sheen_albedo(float roughness, float n_dot_v) {
  float v = n_dot_v;
  float q = inversesqrt(roughness);
  float e = -1.412 - 2.103 * v + 0.838 * q + 3.868 * v * v + 1.351 * v * q + 0.101 * q * q -
            1.925 * v * v * v - 1.159 * v * v * q - 1.587 * v * q * q - 0.031 * q * q * q;
  return min(exp(e), 1.0);
}
