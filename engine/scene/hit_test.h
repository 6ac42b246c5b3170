#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "engine/pipeline/reconstruction.h"

namespace planecast::engine {

/// Half line in the world; `direction` has the length of one unit of depth along the optical axis.
struct Ray {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();
};

struct Hit {
  int plane_id = slam::kNone;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< world
  double depth = 0.0;                               ///< along the optical axis
};

struct HitOptions {
  /// A ray that meets no polygon meets the one whose edge it passes most closely, up to this share
  /// of the hit's depth: estimated outlines end at the last landmark, before the surface does.
  double dilation = 0.25;
};

/// The ray of a raw input pixel.
Ray pixel_ray(const slam::Camera& camera, const slam::Pose& world_from_cam,
              const Eigen::Vector2d& raw_pixel);

/// What a causal run knew of the planes at a frame; else the finished map's.
std::vector<PlaneRecord> planes_at(const Reconstruction& reconstruction, int frame, bool causal);

/// Nearest plane polygon that the ray meets from its front; nothing when it meets none.
std::optional<Hit> hit_test(const std::vector<PlaneRecord>& planes, const Ray& ray,
                            const HitOptions& options = {});

/// Pose of a frame: final, or as known at that frame. Throws UserError "`where`: frame N ..." when
/// the sequence has no such frame or the frame has no pose.
slam::Pose frame_pose(const Reconstruction& reconstruction, int frame, bool causal,
                      const std::string& where);

/// As a tap on that frame; causal, on the planes as they were known then (planes_as_known). Throws
/// UserError beginning with `where` and naming what is there.
Hit tap(const Reconstruction& reconstruction, int frame, const Eigen::Vector2d& raw_pixel,
        bool causal, const std::string& where);

}  // namespace planecast::engine
