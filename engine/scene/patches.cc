#include "engine/scene/patches.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "engine/convert.h"

namespace planecast::engine {
namespace {

constexpr double kEdgeSoftness = 0.03;  ///< of the median depth
constexpr double kRoomAround = 1.6;     ///< circle of certain surface, of the footprint's radius

/// A square grid over part of a plane; cell (0, 0) has its centre at `origin`.
struct Grid {
  Eigen::Vector2d origin;
  double cell = 1.0;

  cv::Point to_cell(const Eigen::Vector2d& p) const {
    const Eigen::Vector2d scaled = (p - origin) / cell;
    return {static_cast<int>(std::lround(scaled.x())), static_cast<int>(std::lround(scaled.y()))};
  }
  Eigen::Vector2d to_plane(const cv::Point& p) const {
    return origin + cell * Eigen::Vector2d(p.x, p.y);
  }
};

std::vector<std::vector<cv::Point>> to_cells(const PlaneOutline& outline, const Grid& grid) {
  std::vector<std::vector<cv::Point>> rings(1 + outline.holes.size());
  for (const Eigen::Vector2d& p : outline.outer) rings[0].push_back(grid.to_cell(p));
  for (std::size_t i = 0; i < outline.holes.size(); ++i) {
    for (const Eigen::Vector2d& p : outline.holes[i]) rings[i + 1].push_back(grid.to_cell(p));
  }
  return rings;
}

/// In a plane's frame with x right and y up, counter-clockwise rings have a positive area.
void orient(std::vector<Eigen::Vector2d>& ring, bool counter_clockwise) {
  double area = 0.0;
  for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
    area += ring[j].x() * ring[i].y() - ring[j].y() * ring[i].x();
  }
  if ((area > 0.0) != counter_clockwise) std::ranges::reverse(ring);
}

/// The piece of the mask that holds `seed`, as an outline.
PlaneOutline trace(const cv::Mat& mask, const Grid& grid, const Eigen::Vector2d& seed) {
  std::vector<std::vector<cv::Point>> rings;
  std::vector<cv::Vec4i> tree;
  cv::findContours(mask, rings, tree, cv::RETR_CCOMP, cv::CHAIN_APPROX_SIMPLE);
  const cv::Point seed_cell = grid.to_cell(seed);
  PlaneOutline outline;
  const auto to_ring = [&grid](const std::vector<cv::Point>& cells, bool counter_clockwise) {
    std::vector<cv::Point> simple;
    cv::approxPolyDP(cells, simple, 0.8, true);
    std::vector<Eigen::Vector2d> ring;
    for (const cv::Point& cell : simple) ring.push_back(grid.to_plane(cell));
    orient(ring, counter_clockwise);
    return ring;
  };
  for (std::size_t i = 0; i < rings.size(); ++i) {
    if (tree[i][3] >= 0 || cv::pointPolygonTest(rings[i], seed_cell, false) < 0) continue;
    outline.outer = to_ring(rings[i], true);
    for (int hole = tree[i][2]; hole >= 0; hole = tree[static_cast<std::size_t>(hole)][0]) {
      const auto& cells = rings[static_cast<std::size_t>(hole)];
      if (cells.size() >= 3) outline.holes.push_back(to_ring(cells, false));
    }
  }
  return outline;
}

render::PlanePatch to_patch(const PlaneOutline& outline, const slam::Pose& world_from_plane) {
  const auto lift = [&world_from_plane](const std::vector<Eigen::Vector2d>& ring) {
    std::vector<glm::vec3> corners;
    for (const Eigen::Vector2d& p : ring) {
      corners.push_back(
          to_glm(Eigen::Vector3d(world_from_plane * Eigen::Vector3d(p.x(), p.y(), 0.0))));
    }
    return corners;
  };
  render::PlanePatch patch;
  patch.normal = to_glm(Eigen::Vector3d(world_from_plane.linear().col(2)));
  patch.outer = lift(outline.outer);
  for (const auto& hole : outline.holes) patch.holes.push_back(lift(hole));
  return patch;
}

/// Ground under content that is tied to no plane: a square three sizes wide.
render::PlanePatch free_patch(const ContentItem& item) {
  const slam::Pose& anchor = item.placed.anchor.plane_from_anchor;
  // The ground's normal is the anchor's y for standing and z for hanging content.
  slam::Pose world_from_ground = anchor;
  if (!item.placed.hangs) {
    world_from_ground.linear().col(1) = -anchor.linear().col(2);
    world_from_ground.linear().col(2) = anchor.linear().col(1);
  }
  const double half = 1.5 * item.longest_side;
  PlaneOutline square;
  square.outer = {{-half, -half}, {half, -half}, {half, half}, {-half, half}};
  return to_patch(square, world_from_ground);
}

constexpr double kNearlyParallel = 0.9;  // cosine

bool is_sound(const PlaneRecord& plane, const SoundPlane& sound, double median_depth) {
  return plane.inliers >= sound.min_inliers && plane.rms <= sound.max_rms_share * median_depth &&
         plane.polygon.size() >= 3;
}

/// An item with its plane and its place in the world.
struct Stand {
  const ContentItem& item;
  const PlaneRecord& ground;
  slam::Pose world_from_anchor;
};

std::vector<Stand> stands(const Reconstruction& reconstruction, const Content& content) {
  std::vector<Stand> result;
  for (const ContentItem& item : content.items) {
    const PlaneRecord* ground = find_plane(reconstruction.planes, item.placed.anchor.plane_id);
    const auto anchor = item.placed.anchor.world_from_anchor(reconstruction.planes);
    if (ground != nullptr && anchor) result.push_back({item, *ground, *anchor});
  }
  return result;
}

/// Whether a plane is the ground of the content, or runs so near to it that it is another estimate
/// of it.
bool is_ground(const PlaneRecord& plane, const Stand& stand, double near_plane_share) {
  if (&stand.ground == &plane) return true;
  const double distance =
      std::abs(plane.normal.dot(stand.world_from_anchor.translation()) + plane.offset);
  return plane.normal.dot(stand.ground.normal) > kNearlyParallel &&
         distance < near_plane_share * stand.item.longest_side;
}

/// Whether the item's shadow can be seen on a plane that it does not stand on.
bool shades(const Stand& stand, const PlaneRecord& plane, const CatcherOptions& options) {
  const double reach = options.reach * stand.item.longest_side;
  const Eigen::Vector3d place = stand.world_from_anchor.translation();
  const double height = plane.normal.dot(place) + plane.offset;
  const double below_ground = stand.ground.normal.dot(plane.origin) + stand.ground.offset;
  const bool shielded =
      plane.normal.dot(stand.ground.normal) > kNearlyParallel && below_ground < 0.0;
  if (shielded || height < 0.0 || height > reach) return false;
  const PlaneOutline outline = plane_outline(plane);
  const Eigen::Vector2d foot = (plane.world_from_plane().inverse() * place).head<2>();
  return contains(outline, foot) || distance_to_edge(outline, foot) < reach;
}

}  // namespace

PlaneOutline with_circle(const PlaneOutline& outline, const Eigen::Vector2d& centre, double radius,
                         int cells) {
  if (contains(outline, centre) && distance_to_edge(outline, centre) >= radius) return outline;
  Eigen::AlignedBox2d box = bounding_box(outline);
  box.extend(Eigen::Vector2d(centre.array() - radius));
  box.extend(Eigen::Vector2d(centre.array() + radius));
  Grid grid;
  grid.cell = box.sizes().maxCoeff() / cells;
  constexpr int kBorder = 2;
  grid.origin = box.min().array() - kBorder * grid.cell;
  const Eigen::Vector2d size = box.sizes() / grid.cell;
  cv::Mat mask = cv::Mat::zeros(static_cast<int>(size.y()) + 2 * kBorder + 1,
                                static_cast<int>(size.x()) + 2 * kBorder + 1, CV_8UC1);
  if (outline.outer.size() >= 3) cv::fillPoly(mask, to_cells(outline, grid), cv::Scalar(255));
  cv::circle(mask, grid.to_cell(centre), static_cast<int>(std::lround(radius / grid.cell)),
             cv::Scalar(255), cv::FILLED);
  return trace(mask, grid, centre);
}

std::vector<MapPatch> shadow_catchers(const Reconstruction& reconstruction, const Content& content,
                                      const CatcherOptions& options) {
  std::vector<MapPatch> patches;
  std::map<int, PlaneOutline> outlines;
  for (const ContentItem& item : content.items) {
    if (item.placed.anchor.plane_id == slam::kNone) {
      patches.push_back({slam::kNone, free_patch(item)});
    }
  }
  const std::vector<Stand> all = stands(reconstruction, content);
  for (const Stand& stand : all) {
    const auto [entry, fresh] = outlines.try_emplace(stand.ground.id);
    if (fresh) entry->second = plane_outline(stand.ground);
    const Eigen::Vector2d place =
        stand.item.placed.anchor.plane_from_anchor.translation().head<2>();
    entry->second = with_circle(entry->second, place, kRoomAround * stand.item.footprint);
  }
  for (const PlaneRecord& plane : reconstruction.planes) {
    if (!is_sound(plane, options.sound, reconstruction.median_depth)) continue;
    const bool grounds = std::ranges::any_of(
        all, [&](const Stand& stand) { return is_ground(plane, stand, options.near_plane_share); });
    const bool shaded =
        std::ranges::any_of(all, [&](const Stand& stand) { return shades(stand, plane, options); });
    if (!grounds && shaded) outlines.try_emplace(plane.id, plane_outline(plane));
  }
  for (const auto& [id, outline] : outlines) {
    if (outline.outer.size() < 3) continue;
    patches.push_back(
        {id, to_patch(outline, find_plane(reconstruction.planes, id)->world_from_plane())});
  }
  for (MapPatch& patch : patches) {
    patch.patch.edge_softness_m = static_cast<float>(kEdgeSoftness * reconstruction.median_depth);
  }
  return patches;
}

std::vector<MapPatch> plane_occluders(const Reconstruction& reconstruction, const Content& content,
                                      const OccluderOptions& options) {
  const double depth = reconstruction.median_depth;
  const std::vector<Stand> all = stands(reconstruction, content);
  std::vector<MapPatch> patches;
  for (const PlaneRecord& plane : reconstruction.planes) {
    const bool grounds = std::ranges::any_of(
        all, [&](const Stand& stand) { return is_ground(plane, stand, options.near_plane_share); });
    if (grounds || !is_sound(plane, options.sound, depth)) continue;
    slam::Pose world_from_plane = plane.world_from_plane();
    world_from_plane.translation() -= options.set_back_share * depth * plane.normal;
    patches.push_back({plane.id, to_patch(plane_outline(plane), world_from_plane)});
  }
  return patches;
}

}  // namespace planecast::engine
