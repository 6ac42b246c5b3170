// Dear ImGui's triangles: pixels from the picture's top left corner, y down.
layout(location = 0) in vec2 position_px;
layout(location = 1) in vec2 texture_uv;
layout(location = 2) in vec4 color_srgb;

uniform vec2 size_px;

out vec2 uv;
out vec4 color;

void main() {
  uv = texture_uv;
  color = color_srgb;
  // The picture's first row is the target's first row, so that it is read the right way up.
  gl_Position = vec4(2.0 * position_px / size_px - 1.0, 0.0, 1.0);
}
