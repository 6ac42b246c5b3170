#include "engine/sequence/synth/room_shell.h"

#include <Eigen/Geometry>
#include <cmath>

#include "engine/sequence/synth/prints.h"

namespace planecast::engine::synth {

using Eigen::Vector3d;

WallFrame wall_frame(const ShellOptions& shell, Wall wall) {
  const double x = shell.size.x();
  const double y = shell.size.y();
  switch (wall) {
    case kWallX0:
      return {Vector3d(0, 0, 0), Vector3d::UnitY(), Vector3d::UnitX(), y};
    case kWallX1:
      return {Vector3d(x, y, 0), -Vector3d::UnitY(), -Vector3d::UnitX(), y};
    case kWallY0:
      return {Vector3d(x, 0, 0), -Vector3d::UnitX(), Vector3d::UnitY(), x};
    default:
      return {Vector3d(0, y, 0), Vector3d::UnitX(), -Vector3d::UnitY(), x};
  }
}

Place against_wall(const ShellOptions& shell, Wall wall, double u, double depth, double z) {
  const WallFrame frame = wall_frame(shell, wall);
  // The front, local -y, turned towards the room.
  return {frame.origin + u * frame.right + depth * frame.normal + Vector3d(0, 0, z),
          std::atan2(frame.normal.x(), -frame.normal.y())};
}

void add_shell(RoomModel& model, const ShellOptions& shell) {
  const Vector3d& size = shell.size;
  add_flat(model, Vector3d::Zero(), {size.x(), 0, 0}, {0, size.y(), 0},
           with_decals(shell.floor, shell.floor_decals),
           {"floor", shell.floor_texels_per_m, 0.035F});
  const Texture board = [](float, float v) -> Color {
    const Color white = color_from_srgb(0xECE8E0);
    return v > 0.062F ? white * 0.86F : white;
  };
  for (const Wall wall : {kWallX0, kWallX1, kWallY0, kWallY1}) {
    if (!shell.walls[wall]) continue;
    const WallFrame frame = wall_frame(shell, wall);
    std::vector<Decal> decals = shell.decals[wall];
    if (shell.skirting) {
      decals.push_back({0.0F, 0.0F, static_cast<float>(frame.length), 0.07F, board, 0.006F, 0.0F});
    }
    add_flat(model, frame.origin, frame.length * frame.right, {0, 0, size.z()},
             with_decals(shell.walls[wall], decals),
             {"wall", shell.wall_texels_per_m[wall], 0.045F});
  }
  if (shell.ceiling) {
    add_flat(model, {0, size.y(), size.z()}, {size.x(), 0, 0}, {0, -size.y(), 0},
             plaster(color_from_srgb(0xF3F1EC), 77), {"ceiling", 200.0F, 0.08F});
  }
}

void add_window(RoomModel& model, const ShellOptions& shell, Wall wall, double u, double v,
                double width, double height, const Color& radiance, std::uint64_t seed) {
  // Just before the wall, well within a millimetre: it belongs to the wall's plane.
  constexpr double kBefore = 0.0005;
  const WallFrame frame = wall_frame(shell, wall);
  const Vector3d corner = frame.origin + u * frame.right + v * Vector3d::UnitZ();
  const Texture view = picture(
      draw_window(static_cast<int>(500 * width), static_cast<int>(500 * height), 2, 2, seed),
      static_cast<float>(width), static_cast<float>(height));
  const int index = add_flat(
      model, corner + kBefore * frame.normal, width * frame.right, {0, 0, height},
      [view](float a, float b) -> Color { return 1.5F * view(a, b); }, {"none", 400.0F, 0.1F});
  Patch& pane = model.patches[static_cast<std::size_t>(index)];
  pane.shines = true;
  pane.casts_shadow = false;
  for (const TruePlane& plane : model.planes) {
    const bool same = plane.normal.dot(frame.normal) > 0.999 &&
                      std::abs(plane.normal.dot(corner) + plane.offset) < 1e-6;
    if (same && plane.plane_class == "wall") pane.label = plane.label;
  }
  WindowLight light;
  light.origin = corner.cast<float>();
  light.u_axis = (width * frame.right).cast<float>();
  light.v_axis = Eigen::Vector3f(0, 0, static_cast<float>(height));
  light.radiance = radiance;
  model.windows.push_back(light);
  const Texture white = plaster(color_from_srgb(0xEFECE5), 5);
  add_box(model, against_wall(shell, wall, u + 0.5 * width, 0.08, v - 0.03),
          {width + 0.12, 0.16, 0.03}, BoxTextures::all(white), {"", 400.0F, 0.02F}, true);
}

}  // namespace planecast::engine::synth
