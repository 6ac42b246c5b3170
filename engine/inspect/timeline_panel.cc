#include <algorithm>
#include <map>

#include "engine/inspect/panel.h"
#include "engine/inspect/window.h"

namespace planecast::engine {
namespace {

ImU32 state_ink(const std::string& state) {
  if (state == "tracked") return IM_COL32(77, 178, 125, 255);
  if (state == "localised") return IM_COL32(90, 147, 186, 255);
  if (state == "lost") return IM_COL32(226, 112, 96, 255);
  if (state == "unreadable") return IM_COL32(176, 122, 208, 255);
  return IM_COL32(89, 97, 106, 255);
}

}  // namespace

void InspectWindow::timeline_panel(const InspectRect& rect) {
  const Panel panel("timeline", rect);
  if (ImGui::Button(view_.playing ? "Pause" : "Play", {64.0F, 0.0F})) {
    view_.playing = !view_.playing;
  }
  ImGui::SameLine();
  int position = session_.position();
  ImGui::SetNextItemWidth(-1.0F);
  const std::string words = "frame " + std::to_string(session_.frame().index);
  if (ImGui::SliderInt("##frame", &position, 0, std::max(session_.frame_count() - 1, 1),
                       words.c_str(), ImGuiSliderFlags_NoInput)) {
    session_.go_to(position);
  }
  const ImVec2 room = ImGui::GetContentRegionAvail();
  lane(std::max(room.x, 1.0F), std::max(room.y, 1.0F));
}

/// Inliers as columns in the colours of the frames' states, with the present frame marked.
void InspectWindow::lane(float width, float height) {
  const std::vector<FrameRecord>& frames = session_.reconstruction().frames;
  const ImVec2 low = ImGui::GetCursorScreenPos();
  ImGui::InvisibleButton("lane", {width, height});
  const auto count = static_cast<float>(frames.size());
  if (ImGui::IsItemActive()) {
    const float at = (ImGui::GetIO().MousePos.x - low.x) / width;
    session_.go_to(static_cast<int>(at * count));
  }
  int most = 1;
  for (const FrameRecord& frame : frames) most = std::max(most, frame.inliers);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const float floor = low.y + height;
  const auto columns = static_cast<std::size_t>(width);
  for (std::size_t x = 0; x < columns; ++x) {
    const FrameRecord& frame = frames[x * frames.size() / columns];
    const float share = static_cast<float>(frame.inliers) / static_cast<float>(most);
    const float top = floor - 4.0F - (height - 6.0F) * share;
    const float left = low.x + static_cast<float>(x);
    list.AddRectFilled({left, top}, {left + 1.0F, floor}, state_ink(frame.state));
  }
  const float cursor = low.x + width * (static_cast<float>(session_.position()) + 0.5F) / count;
  list.AddLine({cursor, low.y}, {cursor, floor}, IM_COL32(255, 255, 255, 255), 2.0F);
}

}  // namespace planecast::engine
