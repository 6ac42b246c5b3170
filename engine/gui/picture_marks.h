#pragma once

#include <imgui.h>

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "engine/pipeline/reconstruction.h"
#include "engine/scene/object_record.h"

namespace planecast::engine {

/// Where a raw picture lies on the canvas.
struct PictureArea {
  ImVec2 origin{0.0F, 0.0F};  ///< of the raw pixel (0, 0)'s corner
  float scale = 1.0F;         ///< canvas pixels a raw pixel

  ImVec2 to_canvas(const Eigen::Vector2d& raw_pixel) const;
  Eigen::Vector2d to_picture(const ImVec2& canvas) const;
};

/// One frame's picture as a place to draw on.
struct PictureMarks {
  ImDrawList* list = nullptr;
  PictureArea area;
  const slam::Camera* camera = nullptr;
  slam::Pose cam_from_world = slam::Pose::Identity();

  /// Canvas position of a world point; nothing behind the camera or far outside the picture.
  std::optional<ImVec2> place(const Eigen::Vector3d& world) const;
  /// A world line in pieces, so that it bends with the lens and can be cut at the camera. Dark
  /// below, so that it shows on any picture.
  void line(const Eigen::Vector3d& from, const Eigen::Vector3d& to, ImU32 color,
            float thickness) const;
};

ImU32 plane_ink(int plane_id, float alpha = 1.0F);

/// Outlines and holes of the planes in their colours, with a label (id and class) each; thick for
/// `chosen`.
void mark_planes(const PictureMarks& marks, const std::vector<PlaneRecord>& planes,
                 int chosen = slam::kNone);
/// Map points in front of the camera as dots in their planes' colours.
void mark_points(const PictureMarks& marks, const std::vector<MapPoint>& points);
/// An object's box and its name.
void mark_object(const PictureMarks& marks, const ObjectRecord& object, bool chosen);

/// Words on a dark patch whose left middle is `at`.
void mark_words(ImDrawList& list, const ImVec2& at, const std::string& words, ImU32 dot = 0);

/// The ends of the 12 edges of a box that is turned and scaled into the world.
std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> box_edges(const ObjectRecord& object);

/// "frame 12 · tracked · 87 inliers"
std::string frame_words(const FrameRecord& frame);

}  // namespace planecast::engine
