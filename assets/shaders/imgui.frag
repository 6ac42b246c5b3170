// Colours stay encoded, as ImGui mixes them; premultiplied, so that the layer can be composited.
in vec2 uv;
in vec4 color;

layout(binding = 0) uniform sampler2D image;

layout(location = 0) out vec4 premultiplied;

void main() {
  vec4 painted = color * texture(image, uv);
  premultiplied = vec4(painted.rgb * painted.a, painted.a);
}
