#include "engine/gui/picture_marks.h"

#include <array>

#include "engine/output/palette.h"

namespace planecast::engine {
namespace {

constexpr int kPiecesPerEdge = 12;
constexpr double kNearest = 1e-3;  ///< depth at which lines are cut, map units
constexpr ImU32 kShade = IM_COL32(0, 0, 0, 110);
constexpr float kShadeWidth = 2.0F;  ///< of the dark border on either side together

Eigen::Vector3d middle_of(const std::vector<Eigen::Vector3d>& ring) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& corner : ring) sum += corner;
  return sum / static_cast<double>(ring.size());
}

void mark_ring(const PictureMarks& marks, const std::vector<Eigen::Vector3d>& ring, ImU32 color,
               float thickness) {
  for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
    marks.line(ring[j], ring[i], color, thickness);
  }
}

}  // namespace

ImVec2 PictureArea::to_canvas(const Eigen::Vector2d& raw_pixel) const {
  return {origin.x + scale * static_cast<float>(raw_pixel.x() + 0.5),
          origin.y + scale * static_cast<float>(raw_pixel.y() + 0.5)};
}

Eigen::Vector2d PictureArea::to_picture(const ImVec2& canvas) const {
  return {static_cast<double>((canvas.x - origin.x) / scale) - 0.5,
          static_cast<double>((canvas.y - origin.y) / scale) - 0.5};
}

std::optional<ImVec2> PictureMarks::place(const Eigen::Vector3d& world) const {
  const Eigen::Vector3d p = cam_from_world * world;
  if (p.z() < kNearest) return std::nullopt;
  const Eigen::Vector2d pixel = camera->project(p);
  if (!camera->contains(pixel, -0.5 * camera->width)) return std::nullopt;
  return area.to_canvas(camera->distort(pixel));
}

void PictureMarks::line(const Eigen::Vector3d& from, const Eigen::Vector3d& to, ImU32 color,
                        float thickness) const {
  std::array<ImVec2, kPiecesPerEdge + 1> run;
  int count = 0;
  const auto draw = [&] {
    if (count > 1) {
      list->AddPolyline(run.data(), count, kShade, 0, thickness + kShadeWidth);
      list->AddPolyline(run.data(), count, color, 0, thickness);
    }
    count = 0;
  };
  for (int piece = 0; piece <= kPiecesPerEdge; ++piece) {
    const double t = static_cast<double>(piece) / kPiecesPerEdge;
    if (const auto at = place((1.0 - t) * from + t * to)) {
      run[static_cast<std::size_t>(count++)] = *at;
    } else {
      draw();
    }
  }
  draw();
}

ImU32 plane_ink(int plane_id, float alpha) {
  const Rgb rgb = plane_color(plane_id);
  return IM_COL32(rgb[0], rgb[1], rgb[2], static_cast<int>(255.0F * alpha));
}

void mark_planes(const PictureMarks& marks, const std::vector<PlaneRecord>& planes, int chosen) {
  for (const PlaneRecord& plane : planes) {
    if (plane.polygon.empty()) continue;
    const float thickness = plane.id == chosen ? 4.0F : 2.0F;
    mark_ring(marks, plane.polygon, plane_ink(plane.id), thickness);
    for (const auto& hole : plane.holes) mark_ring(marks, hole, plane_ink(plane.id), thickness);
  }
  for (const PlaneRecord& plane : planes) {
    if (plane.polygon.empty()) continue;
    if (const auto at = marks.place(middle_of(plane.polygon))) {
      mark_words(*marks.list, *at, std::to_string(plane.id) + " " + plane.plane_class,
                 plane_ink(plane.id));
    }
  }
}

void mark_points(const PictureMarks& marks, const std::vector<MapPoint>& points) {
  for (const MapPoint& point : points) {
    const auto at = marks.place(point.position);
    if (!at) continue;
    const ImVec2 low(at->x - 1.0F, at->y - 1.0F);
    marks.list->AddRectFilled(low, {low.x + 2.0F, low.y + 2.0F}, plane_ink(point.plane, 0.85F));
  }
}

std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> box_edges(const ObjectRecord& object) {
  std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> edges;
  const auto corner = [&object](unsigned bits) -> Eigen::Vector3d {
    const Eigen::Vector3d upper((bits & 1U) != 0 ? 1.0 : 0.0, (bits & 2U) != 0 ? 1.0 : 0.0,
                                (bits & 4U) != 0 ? 1.0 : 0.0);
    return object.world_from_model * (object.box.min() + upper.cwiseProduct(object.box.sizes()));
  };
  for (unsigned from = 0; from < 8; ++from) {
    for (const unsigned axis : {1U, 2U, 4U}) {
      if ((from & axis) == 0) edges.emplace_back(corner(from), corner(from | axis));
    }
  }
  return edges;
}

void mark_object(const PictureMarks& marks, const ObjectRecord& object, bool chosen) {
  const ImU32 color = chosen ? IM_COL32(255, 200, 60, 255) : IM_COL32(235, 235, 240, 180);
  for (const auto& [from, to] : box_edges(object)) {
    marks.line(from, to, color, chosen ? 2.0F : 1.0F);
  }
  const Eigen::Vector3d& top = object.box.max();
  const Eigen::Vector3d above(object.box.center().x(), top.y(), object.box.center().z());
  if (const auto at = marks.place(object.world_from_model * above)) {
    mark_words(*marks.list, *at, object.name, color);
  }
}

void mark_words(ImDrawList& list, const ImVec2& at, const std::string& words, ImU32 dot) {
  const ImVec2 size = ImGui::CalcTextSize(words.c_str());
  const float pad = 0.35F * size.y;
  const float room = dot != 0 ? 0.8F * size.y : 0.0F;
  const ImVec2 low(at.x, at.y - 0.5F * size.y - 0.5F * pad);
  const ImVec2 high(at.x + size.x + room + 2.0F * pad, at.y + 0.5F * size.y + 0.5F * pad);
  list.AddRectFilled(low, high, IM_COL32(12, 14, 17, 190), 0.3F * size.y);
  if (dot != 0) {
    list.AddCircleFilled({low.x + pad + 0.25F * size.y, at.y}, 0.25F * size.y, dot);
  }
  list.AddText({low.x + pad + room, at.y - 0.5F * size.y}, IM_COL32(240, 242, 244, 255),
               words.c_str());
}

std::string frame_words(const FrameRecord& frame) {
  std::string words = "frame " + std::to_string(frame.index) + " \u00B7 " + frame.state;
  if (!frame.reason.empty()) words += " (" + frame.reason + ")";
  return words + " \u00B7 " + std::to_string(frame.inliers) + " inliers";
}

}  // namespace planecast::engine
