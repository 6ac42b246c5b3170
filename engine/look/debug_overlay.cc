#include "engine/look/debug_overlay.h"

#include <algorithm>

#include "engine/gui/picture_marks.h"

namespace planecast::engine {
namespace {

constexpr float kFontShare = 0.033F;  ///< of the picture's height
constexpr float kSmallestFont = 12.0F;
constexpr float kMargin = 8.0F;

float font_px(int height) {
  return std::max(kSmallestFont, kFontShare * static_cast<float>(height));
}

}  // namespace

DebugOverlay::DebugOverlay(const Reconstruction& reconstruction)
    : reconstruction_(reconstruction), canvas_(font_px(reconstruction.camera.height)) {}

void DebugOverlay::draw(const FrameRecord& frame, bool causal, cv::Mat& picture) {
  canvas_.gui().begin(picture.cols, picture.rows);
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
  lay_over(canvas_.end(), picture);
}

}  // namespace planecast::engine
