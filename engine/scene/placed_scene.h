#pragma once

#include <Eigen/Geometry>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "engine/pipeline/reconstruction.h"
#include "engine/scene/content.h"
#include "engine/scene/patches.h"
#include "engine/scene/plane_motion.h"
#include "engine/scene/scene_file.h"
#include "render/scene.h"

namespace planecast::engine {

struct PlacedSceneOptions {
  bool causal = false;  ///< everything follows its plane as it was known at each frame
  int ease_frames = 8;
  bool shadows = true;
  Occlusion occlusion = Occlusion::kPlanes;
};

/// Content, shadow catchers and occluders over the frames of a sequence. Both references must
/// outlive it.
class PlacedScene {
 public:
  PlacedScene(const Reconstruction& reconstruction, const Content& content,
              const PlacedSceneOptions& options);

  /// Puts into `scene` what stands where at a frame; `time_s` since the first frame runs animations
  /// and videos. In a causal run, what stands on a plane that is not known yet is left out.
  void at(int frame_index, double time_s, render::LayerScene& scene);
  /// Raw pixels that each object (not its shadow) can cover at a frame, with room for animations.
  std::vector<cv::Rect> bounds(int frame_index, const slam::Camera& camera,
                               const slam::Pose& world_from_cam) const;
  /// Of the longer side, in pixels, of the rectangle about all objects, also where they are outside
  /// of the picture; infinite where one reaches behind the camera, 0 without objects.
  double extent_px(int frame_index, const slam::Camera& camera,
                   const slam::Pose& world_from_cam) const;

 private:
  /// Raw pixels that the item can cover, also outside of the picture; infinite where it reaches
  /// behind the camera. Nothing where it is not placed yet.
  std::optional<Eigen::AlignedBox2d> box_of(std::size_t item, int frame_index,
                                            const slam::Camera& camera,
                                            const slam::Pose& world_from_cam) const;
  std::optional<slam::Pose> world_from_plane(int plane_id, int frame_index) const;
  /// World from the frame of the plane that the item stands on.
  std::optional<slam::Pose> world_from_plane_of(std::size_t item, int frame_index) const;
  void place_patches(const std::vector<MapPatch>& from, int frame_index,
                     std::vector<render::PlanePatch>& to) const;

  const Reconstruction& reconstruction_;
  const Content& content_;
  std::vector<MapPatch> catchers_;
  std::vector<MapPatch> occluders_;
  std::optional<PlaneMotion> motion_;  ///< causal
  /// Causal, by item, empty where it was not placed by a tap: as world_from_plane_of() by position
  /// of the frame.
  std::vector<std::vector<std::optional<slam::Pose>>> under_tap_;
};

}  // namespace planecast::engine
