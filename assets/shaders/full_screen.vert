// One triangle over the whole target; no vertex buffer.
out vec2 v_share;

void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 2.0 : 0.0, gl_VertexID == 2 ? 2.0 : 0.0);
  v_share = corner;
  gl_Position = vec4(2.0 * corner - 1.0, 0.5, 1.0);
}
