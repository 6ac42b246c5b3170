#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/scene/placement.h"

namespace planecast::engine {

/// Rectangle that an object's bounds cover on its plane.
struct BaseRectangle {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< plane's frame
  Eigen::Vector2d right = Eigen::Vector2d::UnitX();  ///< unit, along the model's x
  Eigen::Vector2d half = Eigen::Vector2d::Zero();    ///< half sides along `right` and across
};
BaseRectangle base_of(const PlacedObject& placed);

/// Shortest motion of `b` that takes it off `a` by `gap`; zero where they are apart.
Eigen::Vector2d way_out(const BaseRectangle& a, const BaseRectangle& b, double gap);

struct Standing {
  PlacedObject* placed = nullptr;
  int carried_by = -1;  ///< index of the earlier object that it stands on; -1: its plane
};

/// Moves objects along their planes so that the bases of no two on one plane overlap. An object
/// gives way to those before it: by the shortest way that clears their oriented rectangles and a
/// small gap, or, where there is no room between others, to the nearest free place on rings about
/// its own. Objects that stand on others move with them and are not looked at themselves.
void keep_apart(const std::vector<Standing>& objects);

}  // namespace planecast::engine
