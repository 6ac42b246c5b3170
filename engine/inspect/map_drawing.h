#pragma once

#include <imgui.h>

#include <Eigen/Core>
#include <array>
#include <vector>

#include "engine/inspect/map_camera.h"
#include "engine/inspect/session.h"

namespace planecast::engine {

struct MapDrawingOptions {
  bool points = true;
  bool planes = true;
  bool path = true;
  bool objects = true;
};

/// The map in 3D as ImGui's own lines and triangles: points, plane patches (far ones first), camera
/// path and keyframes, the present camera, the objects' boxes.
class MapDrawing {
 public:
  explicit MapDrawing(const Reconstruction& reconstruction);

  /// Into the rectangle of `list` from `low` to `high`.
  void draw(ImDrawList& list, const ImVec2& low, const ImVec2& high, const MapCamera& camera,
            const InspectSession& session, const MapDrawingOptions& options) const;

 private:
  struct Patch {
    const PlaneRecord* plane = nullptr;
    std::vector<std::array<Eigen::Vector3d, 3>> triangles;
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  };
  std::vector<Patch> patches_;
};

}  // namespace planecast::engine
