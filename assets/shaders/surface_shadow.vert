layout(location = 0) in vec3 a_position;
layout(location = 1) in vec3 a_normal;

uniform mat4 u_clip_from_world;
uniform vec3 u_to_light;

out float v_towards_light;

void main() {
  v_towards_light = dot(a_normal, u_to_light);
  gl_Position = u_clip_from_world * vec4(a_position, 1.0);
}
