// IEC 61966-2-1, linear to encoded.
vec3 srgb_encode(vec3 linear) {
  vec3 c = clamp(linear, 0.0, 1.0);
  return mix(12.92 * c, 1.055 * pow(max(c, vec3(1e-7)), vec3(1.0 / 2.4)) - 0.055,
             step(vec3(0.0031308), c));
}

vec3 srgb_decode(vec3 encoded) {
  return mix(encoded / 12.92, pow((encoded + 0.055) / 1.055, vec3(2.4)),
             step(vec3(0.04045), encoded));
}
