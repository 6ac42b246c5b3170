// For each ray of the light: whether something stands between the light and a plane, and how far before
// the plane. Averaged over the texels of the shadow map that fall into one here, and further by mip
// levels, so that a soft shadow of any width is a few reads.
uniform sampler2D u_shadow_depth;
uniform int u_factor;
uniform vec4 u_plane;  // in the shadow map's clip space
uniform float u_shadow_depth_m;

layout(location = 0) out vec2 o_blocked_and_gap_m;

void main() {
  ivec2 first = ivec2(gl_FragCoord.xy) * u_factor;
  float texels = float(textureSize(u_shadow_depth, 0).x);
  float blocked = 0.0;
  float gap = 0.0;
  for (int y = 0; y < u_factor; ++y) {
    for (int x = 0; x < u_factor; ++x) {
      ivec2 texel = first + ivec2(x, y);
      vec2 clip = (vec2(texel) + 0.5) / texels * 2.0 - 1.0;
      float plane_depth = -(u_plane.x * clip.x + u_plane.y * clip.y + u_plane.w) / u_plane.z;
      float depth = texelFetch(u_shadow_depth, texel, 0).r;
      float blocks = depth < min(plane_depth, 1.0) ? 1.0 : 0.0;
      blocked += blocks;
      gap += blocks * (plane_depth - depth) * u_shadow_depth_m;
    }
  }
  o_blocked_and_gap_m = vec2(blocked, gap) / float(u_factor * u_factor);
}
