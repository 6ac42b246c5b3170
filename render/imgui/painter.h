#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "render/image.h"
#include "render/renderer.h"

struct ImDrawData;

namespace planecast::render {

/// Draws Dear ImGui's output offscreen, without the libGL that ImGui's own backend opens. The same
/// bytes for the same input. Not thread-safe: one painter, one thread.
class ImGuiPainter {
 public:
  /// Textures by number, chosen by the caller; ImGui's ImTextureID holds the number.
  using TextureId = std::uintptr_t;

  /// `shader_dir` is assets/shaders. Throws std::runtime_error when no context can be made.
  explicit ImGuiPainter(const std::string& shader_dir, ContextKind kind = ContextKind::kOsMesa);
  ~ImGuiPainter();
  ImGuiPainter(const ImGuiPainter&) = delete;
  ImGuiPainter& operator=(const ImGuiPainter&) = delete;

  /// Uploads 3 or 4 channels, replacing what had that number.
  void set_texture(TextureId id, const ImageU8& image);
  /// The display of `data` as RGBA with premultiplied alpha over nothing, top row first. Triangles
  /// of a texture that was never set are left out.
  ImageU8 draw(const ImDrawData& data);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace planecast::render
