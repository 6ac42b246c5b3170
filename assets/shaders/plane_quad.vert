// A rectangle of a plane; no vertex buffer.
uniform mat4 u_clip_from_world;
uniform vec3 u_origin;
uniform vec3 u_axis_x;
uniform vec3 u_axis_y;
uniform vec2 u_region_min;
uniform vec2 u_region_max;

out vec2 v_plane;
out vec3 v_world;

void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  v_plane = mix(u_region_min, u_region_max, corner);
  v_world = u_origin + u_axis_x * v_plane.x + u_axis_y * v_plane.y;
  gl_Position = u_clip_from_world * vec4(v_world, 1.0);
}
