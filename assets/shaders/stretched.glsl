// Anisotropic filtering by hand: several trilinear taps along the longer axis of the pixel's footprint.
// The software rasteriser's own filter is slow and does not end where a derivative is not finite, as
// beside the edge of a triangle that is seen edge-on.
const float kMaxTaps = 8.0;

// One tap; large colour textures are kept encoded, because this rasteriser filters plain bytes several
// times faster than sRGB ones.
vec4 tap(sampler2D image, vec2 uv, float level) {
  vec4 value = textureLod(image, uv, level);
#ifdef BASE_COLOR_ENCODED
  value.rgb = srgb_decode(value.rgb);
#endif
  return value;
}

vec4 sample_stretched(sampler2D image, vec2 uv) {
  vec2 size = vec2(textureSize(image, 0));
  vec2 across = dFdx(uv) * size;
  vec2 down = dFdy(uv) * size;
  float across2 = dot(across, across);
  float down2 = dot(down, down);
  float long2 = max(across2, down2);
  if (!(long2 < 1e10)) return tap(image, vec2(0.5), 16.0);
  vec2 axis = (across2 > down2 ? across : down) / size;
  float taps = clamp(ceil(sqrt(long2 / max(min(across2, down2), 1.0))), 1.0, kMaxTaps);
  float level = 0.5 * log2(max(long2 / (taps * taps), 1.0));
  vec4 sum = vec4(0.0);
  for (int i = 0; i < int(taps); ++i) {
    sum += tap(image, uv + axis * ((float(i) + 0.5) / taps - 0.5), level);
  }
  return sum / taps;
}
