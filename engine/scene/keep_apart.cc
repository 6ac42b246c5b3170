#include "engine/scene/keep_apart.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace planecast::engine {
namespace {

constexpr double kGapShare = 0.04;  ///< of the smaller one's longer side

Eigen::Vector2d across(const Eigen::Vector2d& v) { return {-v.y(), v.x()}; }

/// Half of the rectangle's shadow on the line along `axis`.
double reach(const BaseRectangle& r, const Eigen::Vector2d& axis) {
  return r.half.x() * std::abs(axis.dot(r.right)) +
         r.half.y() * std::abs(axis.dot(across(r.right)));
}

Eigen::Vector2d way_out(const BaseRectangle& a, const BaseRectangle& b) {
  return way_out(a, b, 2.0 * kGapShare * std::min(a.half.maxCoeff(), b.half.maxCoeff()));
}

bool is_clear(const std::vector<BaseRectangle>& others, const BaseRectangle& base) {
  return std::ranges::all_of(others, [&base](const BaseRectangle& other) {
    return way_out(other, base) == Eigen::Vector2d::Zero();
  });
}

/// Where the rectangle finds room, first by giving way to one after the other.
Eigen::Vector2d free_centre(const std::vector<BaseRectangle>& others, const BaseRectangle& wanted) {
  constexpr int kRounds = 4;
  BaseRectangle base = wanted;
  for (int round = 0; round < kRounds && !is_clear(others, base); ++round) {
    for (const BaseRectangle& other : others) base.centre += way_out(other, base);
  }
  if (is_clear(others, base)) return base.centre;
  constexpr int kDirections = 24;
  const double step = 0.25 * wanted.half.maxCoeff();
  // Beyond a ring as wide as all of them in a row there is always room.
  double farthest = 0.0;
  for (const BaseRectangle& other : others) farthest += 2.0 * other.half.norm();
  for (double radius = step; radius < farthest + 4.0 * wanted.half.norm(); radius += step) {
    for (int i = 0; i < kDirections; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kDirections;
      base.centre = wanted.centre + radius * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      if (is_clear(others, base)) return base.centre;
    }
  }
  return wanted.centre;
}

/// Moves an object, and what it carries, in its plane.
void move(const std::vector<Standing>& objects, std::size_t moved, const Eigen::Vector2d& by) {
  std::vector<bool> goes(objects.size(), false);
  for (std::size_t i = moved; i < objects.size(); ++i) {
    const int below = objects[i].carried_by;
    goes[i] = i == moved || (below >= 0 && goes[static_cast<std::size_t>(below)]);
    if (!goes[i]) continue;
    objects[i].placed->anchor.plane_from_anchor.pretranslate(Eigen::Vector3d(by.x(), by.y(), 0.0));
  }
}

}  // namespace

BaseRectangle base_of(const PlacedObject& placed) {
  const slam::Pose& anchor = placed.anchor.plane_from_anchor;
  const Eigen::Vector2d right = anchor.linear().col(0).head<2>();
  BaseRectangle base;
  base.centre = anchor.translation().head<2>();
  if (right.norm() > 1e-9) base.right = right.normalized();
  base.half =
      0.5 * Eigen::Vector2d(placed.sides.x(), placed.hangs ? placed.sides.y() : placed.sides.z());
  return base;
}

Eigen::Vector2d way_out(const BaseRectangle& a, const BaseRectangle& b, double gap) {
  Eigen::Vector2d shortest = Eigen::Vector2d::Zero();
  double least = std::numeric_limits<double>::infinity();
  const std::array<Eigen::Vector2d, 4> axes = {a.right, across(a.right), b.right, across(b.right)};
  for (const Eigen::Vector2d& axis : axes) {
    const double between = axis.dot(b.centre - a.centre);
    const double depth = reach(a, axis) + reach(b, axis) - std::abs(between);
    if (depth <= 0.0) return Eigen::Vector2d::Zero();
    if (depth >= least) continue;
    least = depth;
    shortest = (between < 0.0 ? -1.0 : 1.0) * (depth + gap) * axis;
  }
  return shortest;
}

void keep_apart(const std::vector<Standing>& objects) {
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const int plane = objects[i].placed->anchor.plane_id;
    if (objects[i].carried_by >= 0 || plane == slam::kNone) continue;
    std::vector<BaseRectangle> others;
    for (std::size_t k = 0; k < i; ++k) {
      if (objects[k].carried_by < 0 && objects[k].placed->anchor.plane_id == plane) {
        others.push_back(base_of(*objects[k].placed));
      }
    }
    const BaseRectangle base = base_of(*objects[i].placed);
    const Eigen::Vector2d centre = free_centre(others, base);
    if (centre != base.centre) move(objects, i, centre - base.centre);
  }
}

}  // namespace planecast::engine
