// Surroundings as real spherical harmonics of order 2; band l of the basis times `band[l]`.
uniform vec3 u_ambient_sh[9];

vec3 evaluate_sh(vec3 n, vec3 band) {
  vec3 sum = band.x * 0.282095 * u_ambient_sh[0];
  sum += band.y * 0.488603 * (n.y * u_ambient_sh[1] + n.z * u_ambient_sh[2] + n.x * u_ambient_sh[3]);
  sum += band.z * (1.092548 * (n.x * n.y * u_ambient_sh[4] + n.y * n.z * u_ambient_sh[5] +
                               n.x * n.z * u_ambient_sh[7]) +
                   0.315392 * (3.0 * n.z * n.z - 1.0) * u_ambient_sh[6] +
                   0.546274 * (n.x * n.x - n.y * n.y) * u_ambient_sh[8]);
  return max(sum, vec3(0.0));
}

// Irradiance / pi: the cosine lobe has the band factors pi, 2 pi / 3, pi / 4 (Ramamoorthi 2001).
vec3 diffuse_ambient(vec3 n) { return evaluate_sh(n, vec3(1.0, 2.0 / 3.0, 0.25)); }
