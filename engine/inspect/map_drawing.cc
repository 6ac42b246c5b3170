#include "engine/inspect/map_drawing.h"

#include <algorithm>
#include <optional>

#include "engine/gui/picture_marks.h"
#include "engine/output/ear_clip.h"
#include "engine/scene/plane_outline.h"

namespace planecast::engine {
namespace {

constexpr std::size_t kMostPoints = 12000;
constexpr double kFrustumShare = 0.08;  ///< of the map's radius
constexpr float kPatchAlpha = 0.22F;
constexpr float kChosenAlpha = 0.55F;
constexpr ImU32 kPathInk = IM_COL32(225, 228, 232, 220);
constexpr ImU32 kKeyframeInk = IM_COL32(225, 228, 232, 255);
constexpr ImU32 kCameraInk = IM_COL32(90, 170, 255, 255);
constexpr ImU32 kObjectInk = IM_COL32(235, 235, 240, 200);
constexpr ImU32 kChosenInk = IM_COL32(255, 200, 60, 255);

/// A list, a camera, and where its picture lies.
struct Pencil {
  ImDrawList& list;
  const MapCamera& camera;
  ImVec2 middle;
  float height;

  std::optional<ImVec2> place(const Eigen::Vector3d& world) const {
    const auto projected = camera.project(world);
    if (!projected) return std::nullopt;
    return ImVec2(middle.x + height * static_cast<float>(projected->at.x()),
                  middle.y + height * static_cast<float>(projected->at.y()));
  }
  void line(const Eigen::Vector3d& from, const Eigen::Vector3d& to, ImU32 ink,
            float thickness) const {
    const auto a = place(from);
    const auto b = place(to);
    if (a && b) list.AddLine(*a, *b, ink, thickness);
  }
};

void draw_points(const Pencil& pencil, const std::vector<MapPoint>& points) {
  const std::size_t step = points.size() / (kMostPoints + 1) + 1;
  for (std::size_t i = 0; i < points.size(); i += step) {
    if (const auto at = pencil.place(points[i].position)) {
      pencil.list.AddRectFilled(*at, {at->x + 1.5F, at->y + 1.5F},
                                plane_ink(points[i].plane, 0.9F));
    }
  }
}

void draw_ring(const Pencil& pencil, const std::vector<Eigen::Vector3d>& ring, ImU32 ink,
               float thickness) {
  for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
    pencil.line(ring[j], ring[i], ink, thickness);
  }
}

void draw_path(const Pencil& pencil, const Reconstruction& reconstruction) {
  const FrameRecord* last = nullptr;
  for (const FrameRecord& frame : reconstruction.frames) {
    const bool both = last != nullptr && last->world_from_cam && frame.world_from_cam;
    if (both) {
      pencil.line(last->world_from_cam->translation(), frame.world_from_cam->translation(),
                  kPathInk, 1.5F);
    }
    last = &frame;
  }
  for (const KeyframeRecord& keyframe : reconstruction.keyframes) {
    if (const auto at = pencil.place(keyframe.world_from_cam.translation())) {
      pencil.list.AddCircleFilled(*at, 2.5F, kKeyframeInk, 8);
    }
  }
}

void draw_camera(const Pencil& pencil, const slam::Camera& camera, const slam::Pose& world_from_cam,
                 double depth) {
  std::array<Eigen::Vector3d, 4> corners;
  const std::array<Eigen::Vector2d, 4> pixels = {
      Eigen::Vector2d(0, 0), Eigen::Vector2d(camera.width, 0),
      Eigen::Vector2d(camera.width, camera.height), Eigen::Vector2d(0, camera.height)};
  for (std::size_t i = 0; i < 4; ++i) corners[i] = world_from_cam * (depth * camera.ray(pixels[i]));
  for (std::size_t i = 0; i < 4; ++i) {
    pencil.line(world_from_cam.translation(), corners[i], kCameraInk, 2.0F);
    pencil.line(corners[i], corners[(i + 1) % 4], kCameraInk, 2.0F);
  }
}

void draw_objects(const Pencil& pencil, const InspectSession& session) {
  for (std::size_t i = 0; i < session.objects().size(); ++i) {
    const bool chosen = session.selected() == i;
    for (const auto& [from, to] : box_edges(session.objects()[i])) {
      pencil.line(from, to, chosen ? kChosenInk : kObjectInk, chosen ? 2.0F : 1.0F);
    }
  }
}

}  // namespace

MapDrawing::MapDrawing(const Reconstruction& reconstruction) {
  for (const PlaneRecord& plane : reconstruction.planes) {
    if (plane.polygon.size() < 3) continue;
    const PlaneOutline outline = plane_outline(plane);
    const Triangulation flat = triangulate_polygon(outline.outer, outline.holes);
    const slam::Pose world_from_plane = plane.world_from_plane();
    const auto corner = [&](int index) -> Eigen::Vector3d {
      const Eigen::Vector2d& at = flat.vertices[static_cast<std::size_t>(index)];
      return world_from_plane * Eigen::Vector3d(at.x(), at.y(), 0.0);
    };
    Patch& patch = patches_.emplace_back();
    patch.plane = &plane;
    for (const Eigen::Vector3d& at : plane.polygon) patch.middle += at;
    patch.middle /= static_cast<double>(plane.polygon.size());
    for (const auto& [a, b, c] : flat.triangles) {
      patch.triangles.push_back({corner(a), corner(b), corner(c)});
    }
  }
}

void MapDrawing::draw(ImDrawList& list, const ImVec2& low, const ImVec2& high,
                      const MapCamera& camera, const InspectSession& session,
                      const MapDrawingOptions& options) const {
  const Reconstruction& reconstruction = session.reconstruction();
  const Pencil pencil{list,
                      camera,
                      {0.5F * (low.x + high.x), 0.5F * (low.y + high.y)},
                      std::min(high.y - low.y, high.x - low.x)};
  list.PushClipRect(low, high, true);
  if (options.points) draw_points(pencil, reconstruction.points);
  if (options.planes) {
    std::vector<std::pair<double, const Patch*>> far_first;
    const Eigen::Vector3d eye = camera.world_from_camera().translation();
    for (const Patch& patch : patches_)
      far_first.emplace_back(-(patch.middle - eye).norm(), &patch);
    std::ranges::stable_sort(far_first, {}, [](const auto& entry) { return entry.first; });
    for (const auto& [distance, patch] : far_first) {
      const bool chosen = patch->plane->id == session.chosen_plane();
      const ImU32 fill = plane_ink(patch->plane->id, chosen ? kChosenAlpha : kPatchAlpha);
      // Soft edges would show as seams between the triangles.
      const ImDrawListFlags flags = list.Flags;
      list.Flags &= ~ImDrawListFlags_AntiAliasedFill;
      for (const auto& [a, b, c] : patch->triangles) {
        const auto pa = pencil.place(a);
        const auto pb = pencil.place(b);
        const auto pc = pencil.place(c);
        if (pa && pb && pc) list.AddTriangleFilled(*pa, *pb, *pc, fill);
      }
      list.Flags = flags;
      const ImU32 ink = plane_ink(patch->plane->id);
      draw_ring(pencil, patch->plane->polygon, ink, chosen ? 3.0F : 1.5F);
      for (const auto& hole : patch->plane->holes) draw_ring(pencil, hole, ink, 1.0F);
    }
  }
  if (options.path) {
    draw_path(pencil, reconstruction);
    if (session.frame().world_from_cam) {
      draw_camera(pencil, reconstruction.camera, *session.frame().world_from_cam,
                  kFrustumShare * camera.radius());
    }
  }
  if (options.objects) draw_objects(pencil, session);
  list.PopClipRect();
}

}  // namespace planecast::engine
