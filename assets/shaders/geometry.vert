layout(location = 0) in vec3 a_position;
layout(location = 3) in vec2 a_uv0;
layout(location = 4) in vec2 a_uv1;
layout(location = 5) in vec4 a_color;

uniform mat4 u_clip_from_model;

#ifdef ALPHA_MASK
out vec4 v_uv;
out float v_alpha;
#endif

void main() {
#ifdef ALPHA_MASK
  v_uv = vec4(a_uv0, a_uv1);
  v_alpha = a_color.a;
#endif
  gl_Position = u_clip_from_model * vec4(a_position, 1.0);
}
