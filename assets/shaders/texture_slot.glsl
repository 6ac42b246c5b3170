// Which of the two coordinate sets a texture uses, and its transform (KHR_texture_transform).
vec2 slot_uv(vec4 uv01, int set, mat3 transform) {
  vec2 uv = set == 0 ? uv01.xy : uv01.zw;
  return (transform * vec3(uv, 1.0)).xy;
}
