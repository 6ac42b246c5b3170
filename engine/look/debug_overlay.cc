#include "engine/look/debug_overlay.h"

#include <algorithm>
#include <mutex>

#include "engine/gui/picture_marks.h"

namespace planecast::engine {
namespace {

constexpr float kFontShare = 0.033F;  ///< of the picture's height
constexpr float kSmallestFont = 12.0F;
constexpr float kMargin = 8.0F;

/// ImGui has one current context in a process, and frames are painted by several threads.
std::mutex& gui_mutex() {
  static std::mutex mutex;
  return mutex;
}

float font_px(int height) {
  return std::max(kSmallestFont, kFontShare * static_cast<float>(height));
}

}  // namespace

DebugOverlay::DebugOverlay(const Reconstruction& reconstruction) : reconstruction_(reconstruction) {
  const std::lock_guard lock(gui_mutex());
  canvas_ = std::make_unique<GuiCanvas>(font_px(reconstruction.camera.height));
}

DebugOverlay::~DebugOverlay() {
  const std::lock_guard lock(gui_mutex());
  canvas_.reset();
}

void DebugOverlay::draw(const FrameRecord& frame, bool causal, cv::Mat& picture) {
  const std::lock_guard lock(gui_mutex());
  canvas_->gui().begin(picture.cols, picture.rows);
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const auto& pose = causal ? frame.causal_world_from_cam : frame.world_from_cam;
  if (pose) {
    PictureMarks marks;
    marks.list = &list;
    marks.camera = &reconstruction_.camera;
    marks.cam_from_world = pose->inverse();
    mark_planes(marks, reconstruction_.planes);
  }
  const float below = static_cast<float>(picture.rows) - kMargin - ImGui::GetFontSize();
  mark_words(list, {kMargin, below}, frame_words(frame));
  lay_over(canvas_->end(), picture);
}

}  // namespace planecast::engine
