#include <cmath>

#include "engine/inspect/panel.h"
#include "engine/inspect/window.h"

namespace planecast::engine {
namespace {

constexpr double kRadiansPerPx = 0.008;
constexpr double kWheelZoom = 0.9;

}  // namespace

void InspectWindow::map_panel(const InspectRect& rect) {
  const Panel panel("map", rect);
  MapDrawingOptions& shown = view_.map;
  ImGui::Checkbox("Points##map", &shown.points);
  ImGui::SameLine();
  ImGui::Checkbox("Planes##map", &shown.planes);
  ImGui::SameLine();
  ImGui::Checkbox("Path##map", &shown.path);
  ImGui::SameLine();
  ImGui::Checkbox("Objects##map", &shown.objects);
  ImGui::SameLine();
  if (ImGui::Button("Reset")) map_camera_ = MapCamera(session_.reconstruction());
  const ImVec2 low = ImGui::GetCursorScreenPos();
  const ImVec2 room = ImGui::GetContentRegionAvail();
  if (room.x < 2.0F || room.y < 2.0F) return;
  ImGui::InvisibleButton("space", room,
                         ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight |
                             ImGuiButtonFlags_MouseButtonMiddle);
  map_input();
  const ImVec2 high(low.x + room.x, low.y + room.y);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(low, high, ImGui::GetColorU32(ImGuiCol_ChildBg), 4.0F);
  map_drawing_.draw(list, low, high, map_camera_, session_, shown);
}

/// Left button turns, the others shift, the wheel zooms.
void InspectWindow::map_input() {
  const ImGuiIO& io = ImGui::GetIO();
  const ImVec2 size = ImGui::GetItemRectSize();
  if (ImGui::IsItemActive()) {
    if (ImGui::IsMouseDown(0) && !io.KeyShift) {
      map_camera_.turn(kRadiansPerPx * static_cast<double>(io.MouseDelta.x),
                       kRadiansPerPx * static_cast<double>(io.MouseDelta.y));
    } else {
      map_camera_.shift(static_cast<double>(io.MouseDelta.x / size.y),
                        static_cast<double>(io.MouseDelta.y / size.y));
    }
  }
  if (ImGui::IsItemHovered() && io.MouseWheel != 0.0F) {
    map_camera_.zoom(std::pow(kWheelZoom, static_cast<double>(io.MouseWheel)));
  }
}

}  // namespace planecast::engine
