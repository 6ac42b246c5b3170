// Khronos PBR Neutral tone mapper (specification of 2024): colours below the start of the compression
// keep their hue and, but for the reflection of a dielectric's 4 %, their value; highlights fade to white.
const float kCompressionStart = 0.8 - 0.04;
const float kDesaturation = 0.15;

vec3 tone_neutral(vec3 color) {
  float least = min(color.r, min(color.g, color.b));
  float offset = least < 0.08 ? least - 6.25 * least * least : 0.04;
  color -= offset;
  float peak = max(color.r, max(color.g, color.b));
  if (peak < kCompressionStart) return color;
  float room = 1.0 - kCompressionStart;
  float new_peak = 1.0 - room * room / (peak + room - kCompressionStart);
  color *= new_peak / peak;
  float whitened = 1.0 - 1.0 / (kDesaturation * (peak - new_peak) + 1.0);
  return mix(color, vec3(new_peak), whitened);
}
