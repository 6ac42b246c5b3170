layout(location = 0) in vec3 a_position;

uniform mat4 u_clip_from_world;
uniform mat4 u_world_from_shape;
uniform vec4 u_plane;

out float v_height;

void main() {
  vec4 world = u_world_from_shape * vec4(a_position, 1.0);
  v_height = dot(u_plane, world);
  gl_Position = u_clip_from_world * world;
}
