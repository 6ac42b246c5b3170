#include "engine/scene/default_scene.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/assets.h"
#include "engine/scene/hit_test.h"
#include "engine/scene/placement.h"
#include "engine/scene/plane_outline.h"
#include "engine/user_error.h"

namespace planecast::engine {
namespace {

/// Where the views meet one plane.
struct Votes {
  std::vector<Eigen::Vector2d> points;  ///< plane frame
  std::vector<double> depths;
  double weight = 0.0;
};

double class_weight(const PlaneRecord& plane) {
  if (plane.plane_class == "horizontal") return 1.0;
  if (plane.plane_class == "floor") return 0.7;  // tables are nearer and mostly what is filmed
  if (plane.plane_class == "wall" || plane.plane_class == "vertical") return 0.35;
  return plane.plane_class == "ceiling" ? 0.05 : 0.25;
}

/// Fractions of the picture, and what each counts.
using WeightedPixels = std::vector<std::pair<Eigen::Vector2d, double>>;

/// Fractions of the picture whose rays vote; the middle counts most, and content stands better a
/// little below it, where its upper end stays in view.
WeightedPixels voting_pixels() {
  WeightedPixels pixels;
  for (double y = 0.3; y < 0.86; y += 0.11) {
    for (double x = 0.2; x < 0.81; x += 0.12) {
      const double dx = (x - 0.5) / 0.25;
      const double dy = (y - 0.58) / 0.22;
      pixels.emplace_back(Eigen::Vector2d(x, y), std::exp(-0.5 * (dx * dx + dy * dy)));
    }
  }
  return pixels;
}

/// The whole picture, finely: for maps whose planes are small or at the side.
WeightedPixels all_pixels() {
  WeightedPixels pixels;
  constexpr int kSteps = 32;
  for (int y = 1; y < kSteps; ++y) {
    for (int x = 1; x < kSteps; ++x) {
      pixels.emplace_back(Eigen::Vector2d(x, y) / kSteps, 1.0);
    }
  }
  return pixels;
}

std::map<int, Votes> collect_votes(const Reconstruction& reconstruction, int sampled_frames,
                                   const WeightedPixels& pixels) {
  std::vector<const FrameRecord*> posed;
  for (const FrameRecord& frame : reconstruction.frames) {
    if (frame.world_from_cam) posed.push_back(&frame);
  }
  std::map<int, Votes> votes;
  const std::size_t step =
      std::max<std::size_t>(1, posed.size() / static_cast<std::size_t>(sampled_frames));
  const slam::Camera& camera = reconstruction.camera;
  for (std::size_t i = 0; i < posed.size(); i += step) {
    for (const auto& [fraction, weight] : pixels) {
      const Eigen::Vector2d pixel(fraction.x() * (camera.width - 1),
                                  fraction.y() * (camera.height - 1));
      const std::optional<Hit> hit = hit_test(
          reconstruction.planes, pixel_ray(camera, *posed[i]->world_from_cam, pixel), {0.0});
      if (!hit) continue;
      const PlaneRecord& plane = *find_plane(reconstruction.planes, hit->plane_id);
      Votes& mine = votes[hit->plane_id];
      mine.points.push_back((plane.world_from_plane().inverse() * hit->point).head<2>());
      mine.depths.push_back(hit->depth);
      mine.weight += weight * class_weight(plane);
    }
  }
  return votes;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Map points that rise above the plane, in its frame: what stands there already.
std::vector<Eigen::Vector2d> clutter_above(const Reconstruction& reconstruction,
                                           const PlaneRecord& plane, double height) {
  std::vector<Eigen::Vector2d> found;
  const slam::Pose plane_from_world = plane.world_from_plane().inverse();
  for (const MapPoint& point : reconstruction.points) {
    if (point.plane == plane.id) continue;
    const Eigen::Vector3d local = plane_from_world * point.position;
    if (local.z() > 0.08 * height && local.z() < height) found.push_back(local.head<2>());
  }
  return found;
}

struct Choice {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  double clearance = 0.0;  ///< distance to the outline's edge
};

/// The voted point with the best mixture of a central view, room around it and no clutter.
Choice choose_place(const Votes& votes, const PlaneOutline& outline,
                    const std::vector<Eigen::Vector2d>& clutter, double size) {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& point : votes.points) centre += point;
  centre /= static_cast<double>(votes.points.size());
  double spread = 0.0;
  for (const Eigen::Vector2d& point : votes.points) spread += (point - centre).squaredNorm();
  spread = std::max(std::sqrt(spread / static_cast<double>(votes.points.size())), 1e-9);
  const std::size_t step = std::max<std::size_t>(1, votes.points.size() / 400);
  Choice best;
  double best_score = -1e300;
  for (std::size_t i = 0; i < votes.points.size(); i += step) {
    const Eigen::Vector2d& point = votes.points[i];
    const double clearance = distance_to_edge(outline, point);
    const auto near_by = std::ranges::count_if(
        clutter, [&](const Eigen::Vector2d& other) { return (other - point).norm() < 0.6 * size; });
    const double off_centre = (point - centre).norm() / spread;
    const double score = -off_centre + 1.5 * std::min(clearance / size, 1.0) -
                         2.0 * std::min(static_cast<double>(near_by) / 4.0, 1.0);
    if (score <= best_score) continue;
    best_score = score;
    best = {point, clearance};
  }
  return best;
}

}  // namespace

DefaultSceneOptions builtin_models() {
  DefaultSceneOptions options;
  options.standing_model = asset("models/robot.glb");
  options.standing_animation = "Wave";
  options.hanging_model = asset("models/poster.glb");
  return options;
}

SceneFile default_scene(const Reconstruction& reconstruction, const DefaultSceneOptions& options) {
  std::map<int, Votes> votes =
      collect_votes(reconstruction, options.sampled_frames, voting_pixels());
  if (votes.empty()) votes = collect_votes(reconstruction, options.sampled_frames, all_pixels());
  if (votes.empty()) {
    throw UserError(
        "no scene given, and the map has no plane in view to put an object on (planes: " +
        list_planes(reconstruction.planes) + ")");
  }
  const auto& [plane_id, chosen] = *std::ranges::max_element(
      votes, [](const auto& a, const auto& b) { return a.second.weight < b.second.weight; });
  const PlaneRecord& plane = *find_plane(reconstruction.planes, plane_id);
  const PlaneOutline outline = plane_outline(plane);
  const double wanted = options.size_of_view * median(chosen.depths);
  const Choice choice =
      choose_place(chosen, outline, clutter_above(reconstruction, plane, wanted), wanted);
  const double room = 2.0 * options.size_of_patch * choice.clearance;
  // A sliver of a patch shall not make the object invisible.
  const double size = std::clamp(room, 0.5 * wanted, wanted);

  SceneObject object;
  object.where = "default scene";
  object.model =
      is_vertical(reconstruction, plane) ? options.hanging_model : options.standing_model;
  const Eigen::AlignedBox2d box = bounding_box(outline);
  PlanePlace place;
  place.plane = std::to_string(plane_id);
  place.at = (choice.place - box.min()).cwiseQuotient(box.sizes());
  object.place = place;
  object.size = reconstruction.metric ? size : size / reconstruction.median_depth;
  if (!is_vertical(reconstruction, plane)) object.animation = options.standing_animation;
  SceneFile scene;
  scene.objects.push_back(object);
  return scene;
}

}  // namespace planecast::engine
