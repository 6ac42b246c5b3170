// Surfaces of an opaque scene: already in the world. The ambient part is as smooth as the normals, so
// it is computed a vertex.
layout(location = 0) in vec3 a_position;
layout(location = 1) in vec3 a_normal;
layout(location = 3) in vec2 a_uv;

uniform mat4 u_clip_from_world;

#include "ambient.glsl"

out vec3 v_world;
out vec3 v_normal;
out vec2 v_uv;
out vec3 v_ambient;

void main() {
  v_world = a_position;
  v_normal = a_normal;
  v_uv = a_uv;
  v_ambient = diffuse_ambient(normalize(a_normal));
  gl_Position = u_clip_from_world * vec4(a_position, 1.0);
}
