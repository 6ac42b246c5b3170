#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "engine/pipeline/reconstruction.h"

namespace planecast::engine {

/// A plane's polygon in the plane's own frame (x, y of world_from_plane), same order of corners.
struct PlaneOutline {
  std::vector<Eigen::Vector2d> outer;
  std::vector<std::vector<Eigen::Vector2d>> holes;
};

PlaneOutline plane_outline(const PlaneRecord& plane);

/// Inside the outer ring and in no hole. Even-odd rule; a ring of fewer than 3 corners holds
/// nothing.
bool contains(const PlaneOutline& outline, const Eigen::Vector2d& point);
/// To the nearest edge of any ring, unsigned; infinite without edges.
double distance_to_edge(const PlaneOutline& outline, const Eigen::Vector2d& point);
/// Of the outer ring; empty when there is none.
Eigen::AlignedBox2d bounding_box(const PlaneOutline& outline);

/// The plane with this id, or the one it was merged into; null when there is none.
const PlaneRecord* find_plane(const std::vector<PlaneRecord>& planes, int id);

/// "2 (floor), 5 (wall)" for messages, at most a dozen.
std::string list_planes(const std::vector<PlaneRecord>& planes);

}  // namespace planecast::engine
