#pragma once

#include <cstdint>
#include <vector>

#include "engine/sequence/synth/camera_path.h"
#include "engine/sequence/synth/prints.h"
#include "engine/sequence/synth/room_model.h"
#include "engine/sequence/synth/scenes.h"

/// What the scenes are put together from.
namespace planecast::engine::synth {

inline Color paint(std::uint32_t rgb) { return color_from_srgb(rgb); }

/// A print on a wall, its lower left corner at (u, v).
Decal hang(PrintKind kind, double u, double v, double width, double height, std::uint64_t seed);
/// A print that lies on a floor or table, turned by `yaw`.
Decal lay(PrintKind kind, double u, double v, double width, double height, double yaw,
          std::uint64_t seed);
Decal spread_rug(double u, double v, double width, double height, std::uint32_t seed);
Eigen::Vector3f sun_direction(double x, double y, double z);

/// A camera on an arc about a vertical line.
struct OrbitStep {
  double azimuth_deg;
  double radius_m;
  double height_m;
  double look_height_m;  ///< of the point on the line that is looked at
};
std::vector<PathKey> orbit(const Eigen::Vector3d& centre, const std::vector<OrbitStep>& steps,
                           double step_s);

/// The scenes of the living room; see scenes.h for the rest.
Scene tabletop(std::uint64_t seed);
Scene room(std::uint64_t seed);
Scene rotation_start(std::uint64_t seed);
Scene tracking_loss(std::uint64_t seed);
Scene dark_room(std::uint64_t seed);

/// The scenes that come back to where they began.
Scene ring_corridor(std::uint64_t seed);
Scene revisited_room(std::uint64_t seed);

}  // namespace planecast::engine::synth
