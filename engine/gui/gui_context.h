#pragma once

#include <cstdint>

#include "render/image.h"

struct ImDrawData;
struct ImGuiContext;

namespace planecast::engine {

/// Texture number of the font; pictures have others (ImTextureID holds the number).
inline constexpr std::uintptr_t kFontTexture = 1;

/// Dear ImGui with our font and colours, without a window or OpenGL: what is drawn depends on the
/// calls, the input and the given time steps alone. ImGui has one current context in a process, so
/// that only one thread at a time may make, use or end any of them.
class GuiContext {
 public:
  /// `font_px` is the height of a line's capitals and descenders. Throws UserError when the font is
  /// missing from the assets.
  explicit GuiContext(float font_px);
  ~GuiContext();
  GuiContext(const GuiContext&) = delete;
  GuiContext& operator=(const GuiContext&) = delete;

  void make_current() const;
  /// Begins a picture of that size, `step_s` after the last one.
  void begin(int width, int height, float step_s = 1.0F / 60.0F) const;
  /// Ends it; valid until the next begin().
  const ImDrawData& end() const;
  /// RGBA, for kFontTexture.
  render::ImageU8 font_image() const;

 private:
  ImGuiContext* context_;
};

}  // namespace planecast::engine
