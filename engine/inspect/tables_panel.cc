#include <string>

#include "engine/inspect/panel.h"
#include "engine/inspect/window.h"

namespace planecast::engine {
namespace {

void cell(const std::string& words) {
  ImGui::TableNextColumn();
  ImGui::TextUnformatted(words.c_str());
}

template <typename... Values>
void cell(const char* format, Values... values) {
  ImGui::TableNextColumn();
  ImGui::Text(format, values...);
}

void pair(const char* name, const std::string& value) {
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::TextDisabled("%s", name);
  cell(value);
}

std::string place_words(const SceneObject& object) {
  if (const auto* pixel = std::get_if<PixelPlace>(&object.place)) {
    return "frame " + std::to_string(pixel->frame) + " at " +
           std::to_string(static_cast<int>(pixel->pixel.x())) + ", " +
           std::to_string(static_cast<int>(pixel->pixel.y()));
  }
  if (const auto* plane = std::get_if<PlanePlace>(&object.place)) return "plane " + plane->plane;
  if (const auto* marker = std::get_if<MarkerPlace>(&object.place)) {
    return "marker " + std::to_string(marker->marker.id);
  }
  if (const auto* below = std::get_if<ObjectPlace>(&object.place)) return "on " + below->object;
  return "free point";
}

}  // namespace

void InspectWindow::tables_panel(const InspectRect& rect) {
  const Panel panel("tables", rect);
  if (!ImGui::BeginTabBar("tabs")) return;
  if (ImGui::BeginTabItem("Objects")) {
    objects_table();
    ImGui::EndTabItem();
  }
  if (ImGui::BeginTabItem("Planes")) {
    planes_table();
    ImGui::EndTabItem();
  }
  if (ImGui::BeginTabItem("Frame")) {
    frame_table();
    ImGui::EndTabItem();
  }
  if (ImGui::BeginTabItem("Timings")) {
    timings_table();
    ImGui::EndTabItem();
  }
  ImGui::EndTabBar();
}

void InspectWindow::objects_table() {
  object_sliders();
  if (!begin_table("objects", {"Model", "Place", "Plane"})) return;
  for (std::size_t i = 0; i < session_.scene().objects.size(); ++i) {
    const SceneObject& object = session_.scene().objects[i];
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    const std::string name = session_.content().items[i].name + "##" + std::to_string(i);
    if (ImGui::Selectable(name.c_str(), session_.selected() == i,
                          ImGuiSelectableFlags_SpanAllColumns)) {
      session_.select(i);
    }
    cell(place_words(object));
    cell("%d", session_.content().items[i].placed.anchor.plane_id);
  }
  ImGui::EndTable();
}

void InspectWindow::object_sliders() {
  if (!session_.selected()) {
    ImGui::TextDisabled("Select an object in the picture, or place one.");
    return;
  }
  const SceneObject& object = session_.scene().objects[*session_.selected()];
  auto size = static_cast<float>(session_.selected_size());
  ImGui::SetNextItemWidth(88.0F);
  const bool sized = ImGui::DragFloat("Size", &size, 0.005F * size, 1e-4F, 1e4F, "%.3f");
  if (ImGui::IsItemActivated()) session_.begin_drag();
  if (sized) session_.set_size(static_cast<double>(size));
  ImGui::SameLine();
  auto yaw = static_cast<float>(object.yaw_deg);
  ImGui::SetNextItemWidth(88.0F);
  const bool yawed = ImGui::SliderFloat("Yaw", &yaw, -180.0F, 180.0F, "%.0f\u00B0");
  if (ImGui::IsItemActivated()) session_.begin_drag();
  if (yawed) session_.set_yaw(static_cast<double>(yaw));
  ImGui::SameLine();
  if (ImGui::Button("Remove")) session_.remove_selected();
}

void InspectWindow::planes_table() {
  if (!begin_table("planes", {"Plane", "Class", "Points", "RMS", "Area", "From"})) return;
  for (const PlaneRecord& plane : session_.reconstruction().planes) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::PushStyleColor(ImGuiCol_Text, plane_ink(plane.id));
    const bool chosen = session_.chosen_plane() == plane.id;
    if (ImGui::Selectable(std::to_string(plane.id).c_str(), chosen,
                          ImGuiSelectableFlags_SpanAllColumns)) {
      session_.choose_plane(chosen ? slam::kNone : plane.id);
    }
    ImGui::PopStyleColor();
    cell(plane.plane_class);
    cell("%d", plane.inliers);
    cell("%.4f", plane.rms);
    cell("%.2f", plane.area);
    cell("%d", plane.first_frame);
  }
  ImGui::EndTable();
}

void InspectWindow::frame_table() {
  const FrameRecord& frame = session_.frame();
  if (!ImGui::BeginTable("frame", 2, ImGuiTableFlags_SizingStretchProp)) return;
  pair("Frame", std::to_string(frame.index));
  pair("Time", std::to_string(frame.timestamp) + " s");
  pair("State", frame.state);
  if (!frame.reason.empty()) pair("Reason", frame.reason);
  pair("Inliers", std::to_string(frame.inliers));
  if (frame.world_from_cam) {
    const Eigen::Vector3d at = frame.world_from_cam->translation();
    pair("Camera",
         std::to_string(at.x()) + ", " + std::to_string(at.y()) + ", " + std::to_string(at.z()));
  }
  const Reconstruction& map = session_.reconstruction();
  pair("Units", map.metric ? "metres" : "the map's own");
  pair("Keyframes", std::to_string(map.keyframes.size()));
  pair("Points", std::to_string(map.points.size()));
  ImGui::EndTable();
}

void InspectWindow::timings_table() {
  if (timings_.empty()) {
    ImGui::TextDisabled("This reconstruction has no timings.json.");
    return;
  }
  if (!begin_table("timings", {"Stage", "Runs", "Mean ms", "Median", "95 %"})) return;
  for (const TimingRow& row : timings_) {
    if (row.ms.count == 0) continue;
    ImGui::TableNextRow();
    cell(row.name);
    cell("%d", row.ms.count);
    cell("%.2f", row.ms.mean);
    cell("%.2f", row.ms.median);
    cell("%.2f", row.ms.p95);
  }
  ImGui::EndTable();
}

}  // namespace planecast::engine
