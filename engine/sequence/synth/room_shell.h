#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/sequence/synth/room_model.h"

namespace planecast::engine::synth {

/// The walls of a room [0, x] x [0, y], by the side on which they stand.
enum Wall { kWallX0, kWallX1, kWallY0, kWallY1 };

struct ShellOptions {
  Eigen::Vector3d size = {4.6, 4.0, 2.6};
  Texture floor;
  std::vector<Decal> floor_decals;
  std::array<Texture, 4> walls;              ///< by Wall; empty: the wall is left out
  std::array<std::vector<Decal>, 4> decals;  ///< on the walls, seen from inside
  std::array<float, 4> wall_texels_per_m = {450, 450, 450, 450};
  float floor_texels_per_m = 450;
  bool ceiling = true;
  bool skirting = true;
};

/// A wall as seen from inside: u to the right from its lower left corner, v up.
struct WallFrame {
  Eigen::Vector3d origin, right, normal;
  double length = 0.0;
};
WallFrame wall_frame(const ShellOptions& shell, Wall wall);

/// Where a piece with its back to the wall stands: its middle `u` along and `depth` before it.
Place against_wall(const ShellOptions& shell, Wall wall, double u, double depth, double z = 0.0);

void add_shell(RoomModel& model, const ShellOptions& shell);

/// A bright window with a sill; lets the sun in. (u, v) is its lower left corner on the wall.
void add_window(RoomModel& model, const ShellOptions& shell, Wall wall, double u, double v,
                double width, double height, const Color& radiance, std::uint64_t seed);

}  // namespace planecast::engine::synth
