layout(location = 0) in vec3 a_position;
layout(location = 1) in vec3 a_normal;
layout(location = 2) in vec4 a_tangent;
layout(location = 3) in vec2 a_uv0;
layout(location = 4) in vec2 a_uv1;
layout(location = 5) in vec4 a_color;

uniform mat4 u_clip_from_world;
uniform mat4 u_world_from_shape;
uniform mat3 u_normal_matrix;

out vec3 v_world;
out vec3 v_normal;
out vec4 v_tangent;
out vec4 v_uv;
out vec4 v_color;

void main() {
  vec4 world = u_world_from_shape * vec4(a_position, 1.0);
  v_world = world.xyz;
  v_normal = normalize(u_normal_matrix * a_normal);
  v_tangent = vec4(mat3(u_world_from_shape) * a_tangent.xyz, a_tangent.w);
  v_uv = vec4(a_uv0, a_uv1);
  v_color = a_color;
  gl_Position = u_clip_from_world * world;
}
