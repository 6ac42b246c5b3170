// What a depth camera saw hides what lies behind it; 0 is unknown and hides nothing. The comparison is
// soft over a share of the depth, and over neighbouring pixels, so that noisy edges do not flicker.
uniform sampler2D u_occluder_depth;
uniform float u_occluder_tolerance;

float visibility_at(ivec2 pixel, float z) {
  ivec2 last = textureSize(u_occluder_depth, 0) - 1;
  float seen = texelFetch(u_occluder_depth, clamp(pixel, ivec2(0), last), 0).r;
  float behind = (z - seen) / (seen * u_occluder_tolerance + 1e-9);
  return seen > 0.0 ? clamp(1.0 - behind, 0.0, 1.0) : 1.0;
}

float depth_visibility() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  float z = 1.0 / gl_FragCoord.w;
  return 0.4 * visibility_at(pixel, z) +
         0.15 * (visibility_at(pixel + ivec2(1, 0), z) + visibility_at(pixel - ivec2(1, 0), z) +
                 visibility_at(pixel + ivec2(0, 1), z) + visibility_at(pixel - ivec2(0, 1), z));
}
