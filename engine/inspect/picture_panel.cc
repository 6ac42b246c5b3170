#include <algorithm>
#include <cmath>

#include "engine/inspect/panel.h"
#include "engine/inspect/window.h"

namespace planecast::engine {
namespace {

constexpr float kWheelScale = 1.06F;   ///< of the selected object by one notch
constexpr double kDegreesPerPx = 0.5;  ///< of a drag with Shift

void tool_button(const char* name, InspectTool tool, InspectSession& session, const char* help) {
  const bool active = session.tool == tool;
  if (active) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetColorU32(ImGuiCol_TabActive));
  if (ImGui::Button(name)) session.tool = tool;
  if (active) ImGui::PopStyleColor();
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", help);
}

}  // namespace

void InspectWindow::picture_panel(const InspectRect& rect) {
  const Panel panel("picture", rect);
  toolbar();
  const slam::Camera& camera = session_.reconstruction().camera;
  const ImVec2 room = ImGui::GetContentRegionAvail();
  const auto width = static_cast<float>(camera.width);
  const auto height = static_cast<float>(camera.height);
  area_.scale = std::max(std::min(room.x / width, room.y / height), 1e-3F);
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  area_.origin = {corner.x + std::floor(0.5F * (room.x - area_.scale * width)), corner.y};
  const ImVec2 end(area_.origin.x + area_.scale * width, area_.origin.y + area_.scale * height);
  ImGui::SetCursorScreenPos(area_.origin);
  ImGui::InvisibleButton(
      "frame", {std::max(end.x - area_.origin.x, 1.0F), std::max(end.y - area_.origin.y, 1.0F)});
  picture_input(ImGui::IsItemHovered());
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddImage(reinterpret_cast<ImTextureID>(kFrameTexture), area_.origin, end);
  list.PushClipRect(area_.origin, end, true);
  marks(list);
  list.PopClipRect();
}

void InspectWindow::toolbar() {
  tool_button("Move", InspectTool::kMove, session_,
              "Select and drag objects (M). Shift turns, the wheel scales.");
  ImGui::SameLine();
  tool_button("Place", InspectTool::kPlace, session_,
              "Click on a plane to put the model there (P)");
  ImGui::SameLine();
  ImGui::SetNextItemWidth(110.0F);
  const auto& models = session_.models();
  const std::size_t chosen = static_cast<std::size_t>(session_.model);
  const std::string name = chosen < models.size() ? models[chosen].stem().string() : "";
  if (ImGui::BeginCombo("##model", name.c_str())) {
    for (std::size_t i = 0; i < models.size(); ++i) {
      if (ImGui::Selectable(models[i].stem().string().c_str(), i == chosen)) {
        session_.model = static_cast<int>(i);
        session_.tool = InspectTool::kPlace;
      }
    }
    ImGui::EndCombo();
  }
  ImGui::SameLine();
  if (ImGui::Button("Undo")) session_.undo();
  ImGui::SameLine();
  if (ImGui::Button("Redo")) session_.redo();
  ImGui::SameLine();
  if (ImGui::Button("Save")) session_.save();
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", session_.scene_path().c_str());
  ImGui::SameLine();
  ImGui::TextDisabled("%s", session_.unsaved() ? "changed" : "");
  ImGui::Checkbox("Planes", &view_.planes);
  ImGui::SameLine();
  ImGui::Checkbox("Points", &view_.points);
  ImGui::SameLine();
  ImGui::Checkbox("Objects", &view_.objects);
  ImGui::SameLine();
  ImGui::Checkbox("Boxes", &view_.boxes);
  ImGui::SameLine();
  ImGui::TextUnformatted(session_.message().c_str());
}

void InspectWindow::picture_input(bool hovered) {
  const ImGuiIO& io = ImGui::GetIO();
  const Eigen::Vector2d pixel = area_.to_picture(io.MousePos);
  if (ImGui::IsItemActivated()) {
    session_.click(pixel);
    dragging_ = false;
  }
  const bool pulled = ImGui::IsItemActive() && ImGui::IsMouseDragging(0) && session_.selected();
  if (pulled && !dragging_) session_.begin_drag();
  if (pulled && (io.MouseDelta.x != 0.0F || io.MouseDelta.y != 0.0F || !dragging_)) {
    if (io.KeyShift) {
      session_.rotate_by(kDegreesPerPx * static_cast<double>(io.MouseDelta.x));
    } else {
      session_.drag_to(pixel);
    }
  }
  dragging_ = pulled;
  if (hovered && io.MouseWheel != 0.0F && session_.selected()) {
    session_.begin_drag();
    session_.scale_by(std::pow(static_cast<double>(kWheelScale), io.MouseWheel));
  }
}

void InspectWindow::marks(ImDrawList& list) {
  const FrameRecord& frame = session_.frame();
  if (frame.world_from_cam) {
    const Reconstruction& reconstruction = session_.reconstruction();
    PictureMarks marks;
    marks.list = &list;
    marks.area = area_;
    marks.camera = &reconstruction.camera;
    marks.cam_from_world = frame.world_from_cam->inverse();
    if (view_.points) mark_points(marks, reconstruction.points);
    if (view_.planes) mark_planes(marks, reconstruction.planes, session_.chosen_plane());
    for (std::size_t i = 0; view_.boxes && i < session_.objects().size(); ++i) {
      mark_object(marks, session_.objects()[i], session_.selected() == i);
    }
  }
  const auto height = area_.scale * static_cast<float>(session_.reconstruction().camera.height);
  mark_words(list, {area_.origin.x + 8.0F, area_.origin.y + height - 16.0F}, frame_words(frame));
}

}  // namespace planecast::engine
