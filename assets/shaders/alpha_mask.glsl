// Cut-outs for the passes that need no colour.
#include "texture_slot.glsl"
in vec4 v_uv;
in float v_alpha;

uniform sampler2D u_base_color;
uniform mat3 u_base_color_transform;
uniform int u_base_color_set;
uniform float u_alpha_factor;
uniform float u_alpha_cutoff;

void discard_masked() {
  float alpha = v_alpha * u_alpha_factor;
#ifdef BASE_COLOR_MAP
  alpha *= texture(u_base_color, slot_uv(v_uv, u_base_color_set, u_base_color_transform)).a;
#endif
  if (alpha < u_alpha_cutoff) discard;
}
