#pragma once

#include <opencv2/core.hpp>

#include "engine/gui/gui_canvas.h"
#include "engine/inspect/frame_pictures.h"
#include "engine/inspect/window.h"

namespace planecast::engine {

/// The inspector as pictures: what a window shows, and what --screenshot writes.
class InspectScreen {
 public:
  InspectScreen(InspectWindow& window, FramePictures& pictures);

  /// Takes the input that ImGui was given since the last picture. CV_8UC3 BGR.
  cv::Mat draw(int width, int height, float step_s = 1.0F / 60.0F);
  const GuiContext& gui() const { return canvas_.gui(); }

 private:
  InspectWindow& window_;
  FramePictures& pictures_;
  GuiCanvas canvas_;
  int shown_picture_ = -1;
};

/// The picture once the panels have found their sizes; the same bytes for the same session.
cv::Mat inspect_screenshot(InspectScreen& screen, int width, int height);

}  // namespace planecast::engine
