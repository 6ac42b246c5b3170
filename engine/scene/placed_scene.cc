#include "engine/scene/placed_scene.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/convert.h"
#include "engine/scene/plane_outline.h"

namespace planecast::engine {
namespace {

/// Just before the end of an animation that does not loop: the end itself is the next loop's start.
constexpr double kBeforeEnd = 1e-3;

render::Instance to_instance(const ContentItem& item, const Eigen::Affine3d& world_from_model,
                             double time_s) {
  render::Instance instance;
  const double time = item.start_s + time_s;
  instance.model = item.print ? item.print->at(time, item.loop) : item.model;
  instance.world_from_model = to_glm(Eigen::Matrix4d(world_from_model.matrix()));
  instance.animation = item.animation;
  const double last = std::max(0.0, item.animation_end_s - kBeforeEnd);
  instance.animation_time_s = static_cast<float>(item.loop ? time : std::min(time, last));
  return instance;
}

glm::vec3 moved(const slam::Pose& motion, const glm::vec3& point) {
  return to_glm(Eigen::Vector3d(motion * to_eigen(point)));
}

/// Corners of the item's bounds, a third wider, in its anchor's frame.
std::array<Eigen::Vector3d, 8> roomy_box(const PlacedObject& placed) {
  constexpr double kRoom = 1.33;
  const Eigen::Vector3d half = 0.5 * kRoom * placed.sides;
  const Eigen::Vector3d centre(0.0, placed.hangs ? 0.0 : 0.5 * placed.sides.y(),
                               placed.hangs ? 0.5 * placed.sides.z() : 0.0);
  std::array<Eigen::Vector3d, 8> corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector3d sign(i & 1U ? 1.0 : -1.0, i & 2U ? 1.0 : -1.0, i & 4U ? 1.0 : -1.0);
    corners[i] = centre + half.cwiseProduct(sign);
  }
  return corners;
}

}  // namespace

PlacedScene::PlacedScene(const Reconstruction& reconstruction, const Content& content,
                         const PlacedSceneOptions& options)
    : reconstruction_(reconstruction), content_(content) {
  if (options.shadows) catchers_ = shadow_catchers(reconstruction, content);
  if (options.occlusion == Occlusion::kPlanes || options.occlusion == Occlusion::kBoth) {
    occluders_ = plane_occluders(reconstruction, content);
  }
  if (!options.causal) return;
  motion_.emplace(reconstruction, options.ease_frames);
  for (const ContentItem& item : content.items) {
    under_tap_.emplace_back();
    if (!item.placed.tap) continue;
    under_tap_.back() =
        motion_->world_from_plane_under(*item.placed.tap, item.placed.anchor.plane_id);
  }
}

std::optional<slam::Pose> PlacedScene::world_from_plane_of(std::size_t item,
                                                           int frame_index) const {
  if (!motion_ || under_tap_[item].empty()) {
    return world_from_plane(content_.items[item].placed.anchor.plane_id, frame_index);
  }
  const auto position =
      static_cast<std::size_t>(frame_index - reconstruction_.frames.front().index);
  return position < under_tap_[item].size() ? under_tap_[item][position] : std::nullopt;
}

std::optional<slam::Pose> PlacedScene::world_from_plane(int plane_id, int frame_index) const {
  if (plane_id == slam::kNone) return slam::Pose::Identity();
  if (motion_) return motion_->world_from_plane(plane_id, frame_index);
  const PlaneRecord* plane = find_plane(reconstruction_.planes, plane_id);
  if (plane == nullptr) return std::nullopt;
  return plane->world_from_plane();
}

void PlacedScene::place_patches(const std::vector<MapPatch>& from, int frame_index,
                                std::vector<render::PlanePatch>& to) const {
  to.clear();
  for (const MapPatch& patch : from) {
    const std::optional<slam::Pose> now = world_from_plane(patch.plane_id, frame_index);
    if (!now) continue;
    to.push_back(patch.patch);
    if (!motion_ || patch.plane_id == slam::kNone) continue;
    const PlaneRecord& plane = *find_plane(reconstruction_.planes, patch.plane_id);
    const slam::Pose motion = *now * plane.world_from_plane().inverse();
    render::PlanePatch& moving = to.back();
    moving.normal = to_glm(Eigen::Vector3d(motion.linear() * to_eigen(moving.normal)));
    for (glm::vec3& corner : moving.outer) corner = moved(motion, corner);
    for (auto& hole : moving.holes) {
      for (glm::vec3& corner : hole) corner = moved(motion, corner);
    }
  }
}

std::optional<Eigen::AlignedBox2d> PlacedScene::box_of(std::size_t item, int frame_index,
                                                       const slam::Camera& camera,
                                                       const slam::Pose& world_from_cam) const {
  const PlacedObject& placed = content_.items[item].placed;
  const auto plane = world_from_plane_of(item, frame_index);
  if (!plane) return std::nullopt;
  const slam::Pose cam_from_anchor =
      world_from_cam.inverse() * *plane * placed.anchor.plane_from_anchor;
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector3d& corner : roomy_box(placed)) {
    const Eigen::Vector3d p = cam_from_anchor * corner;
    if (p.z() < 1e-3 * reconstruction_.median_depth) {
      const Eigen::Vector2d far = Eigen::Vector2d::Constant(HUGE_VAL);
      return Eigen::AlignedBox2d(-far, far);
    }
    // Far outside the picture the lens model folds back.
    const Eigen::Vector2d pixel = camera.project(p);
    box.extend(camera.contains(pixel) ? camera.distort(pixel) : pixel);
  }
  return box;
}

std::vector<cv::Rect> PlacedScene::bounds(int frame_index, const slam::Camera& camera,
                                          const slam::Pose& world_from_cam) const {
  const Eigen::AlignedBox2d picture(Eigen::Vector2d::Zero(),
                                    Eigen::Vector2d(camera.width, camera.height));
  std::vector<cv::Rect> all;
  for (std::size_t i = 0; i < content_.items.size(); ++i) {
    auto box = box_of(i, frame_index, camera, world_from_cam);
    if (!box || box->intersection(picture).isEmpty()) continue;
    box = box->intersection(picture);
    const cv::Rect item_bounds(static_cast<int>(box->min().x()), static_cast<int>(box->min().y()),
                               static_cast<int>(box->sizes().x()) + 2,
                               static_cast<int>(box->sizes().y()) + 2);
    all.push_back(item_bounds & cv::Rect(0, 0, camera.width, camera.height));
  }
  return all;
}

double PlacedScene::extent_px(int frame_index, const slam::Camera& camera,
                              const slam::Pose& world_from_cam) const {
  Eigen::AlignedBox2d all;
  for (std::size_t i = 0; i < content_.items.size(); ++i) {
    if (const auto box = box_of(i, frame_index, camera, world_from_cam)) all.extend(*box);
  }
  return all.isEmpty() ? 0.0 : all.sizes().maxCoeff();
}

void PlacedScene::at(int frame_index, double time_s, render::LayerScene& scene) {
  scene.instances.clear();
  for (std::size_t i = 0; i < content_.items.size(); ++i) {
    const ContentItem& item = content_.items[i];
    const auto plane = world_from_plane_of(i, frame_index);
    if (!plane) continue;
    scene.instances.push_back(to_instance(item, item.placed.world_from_model(*plane), time_s));
  }
  place_patches(catchers_, frame_index, scene.catchers);
  place_patches(occluders_, frame_index, scene.occluders);
}

}  // namespace planecast::engine
