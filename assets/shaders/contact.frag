// Share of the surroundings' light that the objects on a plane take from each point of it. In each
// direction the column of an object at distance r, from height h to H, hides the elevations between
// atan(h / r) and atan(H / r); the cosine-weighted light below elevation e is sin(e)^2, so it hides
// H^2 / (H^2 + r^2) - h^2 / (h^2 + r^2) of it. Directions and distances alternate over 4 x 4 texels;
// contact_blur.frag puts them together.
in vec2 v_share;

uniform sampler2D u_heights;
uniform vec2 u_region_size_m;
uniform float u_reach_m;

layout(location = 0) out float o_hidden;

const int kDirections = 8;
const int kSteps = 6;

float elevation_share(float height, float distance2) {
  return height * height / (height * height + distance2);
}

void main() {
  ivec2 cell = ivec2(gl_FragCoord.xy) & 3;
  // A Bayer order, so that neighbours differ most.
  int bits = cell.x ^ cell.y;
  int order = ((bits & 1) << 3) | ((cell.y & 1) << 2) | (bits & 2) | (cell.y >> 1);
  float turn = (float(order) + 0.5) / 16.0;
  float jitter = fract(turn * 9.7);
  float sum = 0.0;
  for (int d = 0; d < kDirections; ++d) {
    float angle = 6.2831853 * (float(d) + turn) / float(kDirections);
    vec2 direction = vec2(cos(angle), sin(angle));
    float hidden = 0.0;
    for (int s = 0; s < kSteps; ++s) {
      float share = (float(s) + jitter) / float(kSteps);
      float r = u_reach_m * share * share + 1e-6;
      vec2 heights = textureLod(u_heights, v_share + direction * r / u_region_size_m, 0.0).rg;
      float top = max(heights.x, 0.0);
      float underside = min(max(-heights.y, 0.0), top);
      hidden = max(hidden, elevation_share(top, r * r) - elevation_share(underside, r * r));
    }
    sum += hidden;
  }
  vec2 to_border = min(v_share, 1.0 - v_share);
  float fade = smoothstep(0.0, 0.2, min(to_border.x, to_border.y));
  o_hidden = fade * sum / float(kDirections);
}
