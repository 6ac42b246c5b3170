// Mean over the 4 x 4 pattern of contact.frag.
uniform sampler2D u_heights;

layout(location = 0) out float o_hidden;

void main() {
  ivec2 last = textureSize(u_heights, 0) - 1;
  ivec2 first = ivec2(gl_FragCoord.xy) - 2;
  float sum = 0.0;
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) {
      sum += texelFetch(u_heights, clamp(first + ivec2(x, y), ivec2(0), last), 0).r;
    }
  }
  o_hidden = sum / 16.0;
}
