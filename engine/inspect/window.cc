#include "engine/inspect/window.h"

#include <algorithm>
#include <cmath>

namespace planecast::engine {
namespace {

constexpr float kTimelineHeight = 92.0F;
constexpr float kPictureShare = 0.62F;  ///< of the width
constexpr float kMapShare = 0.55F;      ///< of the height

}  // namespace

InspectLayout inspect_layout(float width, float height) {
  const float left = std::round(kPictureShare * width);
  const float top = std::round(kMapShare * height);
  const float above = height - kTimelineHeight;
  return {{0.0F, 0.0F, left, above},
          {0.0F, above, left, kTimelineHeight},
          {left, 0.0F, width - left, top},
          {left, top, width - left, height - top}};
}

InspectWindow::InspectWindow(InspectSession& session, std::vector<TimingRow> timings, double fps)
    : session_(session),
      timings_(std::move(timings)),
      fps_(fps),
      map_camera_(session.reconstruction()),
      map_drawing_(session.reconstruction()) {}

void InspectWindow::draw() {
  keys();
  play();
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  const InspectLayout layout = inspect_layout(size.x, size.y);
  picture_panel(layout.picture);
  timeline_panel(layout.timeline);
  map_panel(layout.map);
  tables_panel(layout.tables);
}

void InspectWindow::keys() {
  const ImGuiIO& io = ImGui::GetIO();
  if (io.WantTextInput) return;
  const auto pressed = [](ImGuiKey key) { return ImGui::IsKeyPressed(ImGui::GetKeyIndex(key)); };
  const auto letter = [](char key) { return ImGui::IsKeyPressed(key); };
  const int step = io.KeyShift ? 10 : 1;
  if (pressed(ImGuiKey_LeftArrow)) session_.step(-step);
  if (pressed(ImGuiKey_RightArrow)) session_.step(step);
  if (pressed(ImGuiKey_Home)) session_.go_to(0);
  if (pressed(ImGuiKey_End)) session_.go_to(session_.frame_count() - 1);
  if (pressed(ImGuiKey_Space)) view_.playing = !view_.playing;
  if (pressed(ImGuiKey_Delete)) session_.remove_selected();
  if (pressed(ImGuiKey_Escape)) session_.tool = InspectTool::kMove;
  if (io.KeyCtrl && letter('Z')) io.KeyShift ? session_.redo() : session_.undo();
  if (io.KeyCtrl && letter('S')) session_.save();
  if (io.KeyCtrl && letter('Q')) wants_to_close_ = true;
  if (!io.KeyCtrl && letter('P')) session_.tool = InspectTool::kPlace;
  if (!io.KeyCtrl && letter('M')) session_.tool = InspectTool::kMove;
}

void InspectWindow::play() {
  if (!view_.playing) {
    play_time_s_ = 0.0;
    return;
  }
  play_time_s_ += static_cast<double>(ImGui::GetIO().DeltaTime);
  const int frames = static_cast<int>(play_time_s_ * fps_);
  play_time_s_ -= frames / fps_;
  if (frames == 0) return;
  const bool at_end = session_.position() + frames >= session_.frame_count();
  session_.go_to(at_end ? 0 : session_.position() + frames);
}

}  // namespace planecast::engine
