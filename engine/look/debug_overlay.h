#pragma once

#include <memory>
#include <opencv2/core.hpp>

#include "engine/gui/gui_canvas.h"
#include "engine/pipeline/reconstruction.h"

namespace planecast::engine {

/// Draws the planes' outlines in their colours with ids and classes, and one line with the frame's
/// number and state, as the inspector does. Outlines follow the lens. Several may draw at once,
/// each in its own thread.
class DebugOverlay {
 public:
  explicit DebugOverlay(const Reconstruction& reconstruction);
  ~DebugOverlay();
  DebugOverlay(const DebugOverlay&) = delete;
  DebugOverlay& operator=(const DebugOverlay&) = delete;

  /// `picture` is CV_8UC3 BGR of the camera's size.
  void draw(const FrameRecord& frame, bool causal, cv::Mat& picture);

 private:
  const Reconstruction& reconstruction_;
  std::unique_ptr<GuiCanvas> canvas_;
};

}  // namespace planecast::engine
