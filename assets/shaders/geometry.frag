// Depth and label. The clip w is the depth along the optical axis, so that its reciprocal, which the
// rasteriser interpolates exactly linearly on the screen, is all that is needed.
#ifdef ALPHA_MASK
#include "alpha_mask.glsl"
#endif
#ifdef OCCLUDER_DEPTH
#include "occluder_depth.glsl"
#endif

uniform int u_label;

layout(location = 0) out float o_depth_m;
layout(location = 1) out uint o_label;

void main() {
#ifdef ALPHA_MASK
  discard_masked();
#endif
#ifdef OCCLUDER_DEPTH
  if (depth_visibility() < 0.5) discard;
#endif
  o_depth_m = 1.0 / gl_FragCoord.w;
  o_label = uint(u_label);
}
