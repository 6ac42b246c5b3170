#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

#include "engine/gui/gui_context.h"
#include "render/imgui/painter.h"

namespace planecast::engine {

/// Dear ImGui drawn offscreen into pictures. Not thread-safe.
class GuiCanvas {
 public:
  /// Throws UserError when the assets, std::runtime_error when a rendering context is missing.
  explicit GuiCanvas(float font_px);

  const GuiContext& gui() const { return gui_; }
  /// Makes a BGR or RGB picture drawable under a number other than kFontTexture.
  void set_picture(std::uintptr_t id, const cv::Mat& bgr);
  /// What was drawn since gui().begin(), as RGBA with premultiplied alpha, CV_8UC4.
  cv::Mat end();

 private:
  GuiContext gui_;
  render::ImGuiPainter painter_;
};

/// Lays a picture of GuiCanvas over a BGR picture of the same size.
void lay_over(const cv::Mat& rgba_premultiplied, cv::Mat& bgr);

}  // namespace planecast::engine
