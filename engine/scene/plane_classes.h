#pragma once

#include <Eigen/Core>
#include <optional>

#include "engine/pipeline/reconstruction.h"

namespace planecast::engine {

struct UpOptions {
  std::optional<Eigen::Vector3d> known_up;  ///< world direction given by the user; taken as it is
  double same_direction_deg = 12.0;         ///< planes whose normals agree this well are one family
  double max_roll_deg = 15.0;  ///< one standard deviation of how far handheld cameras roll
};

struct UpEstimate {
  Eigen::Vector3d up = -Eigen::Vector3d::UnitY();  ///< unit, world
  double confidence = 0.0;                         ///< 0: nothing known .. 1: given by the user
};

/// Which way is up, from how people hold cameras and how rooms are built. Seen from a camera that
/// does not roll, up lies in its vertical mid plane, between the picture's top (level view) and the
/// way back along the optical axis (view straight down). Every family of parallel planes proposes
/// its normal, and so do the cameras alone; a proposal is supported by the area of the planes
/// parallel and at right angles to it and by how well it agrees with the cameras. Precondition:
/// unit plane normals. The confidence is the winner's lead over the best proposal of another
/// direction.
UpEstimate estimate_up(const Reconstruction& reconstruction, const UpOptions& options = {});

struct ClassOptions {
  double level_deg = 15.0;            ///< horizontal: normal within this of up (or down)
  double upright_deg = 15.0;          ///< vertical: normal within this of level
  double floor_below_camera_m = 0.8;  ///< maps with a scale: a floor is at least this far below
  double wall_area_share = 0.25;  ///< a wall has this share of the largest vertical plane's area
};

/// Sets up, up_confidence and every plane's class. Horizontal planes that face up: the lowest large
/// one is the floor if something shows that it is no table: in maps with a scale its distance below
/// the cameras, else another upward plane above it. Facing down above the cameras: ceiling. Large
/// upright planes are walls, small ones vertical. Everything else is "other".
void classify_planes(Reconstruction& reconstruction, const UpOptions& up_options = {},
                     const ClassOptions& class_options = {});

}  // namespace planecast::engine
