#include "engine/sequence/synth/scene_parts.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "engine/sequence/synth/furniture.h"
#include "engine/sequence/synth/random.h"
#include "engine/sequence/synth/room_shell.h"

namespace planecast::engine::synth {

using Eigen::Vector3d;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRadians = std::numbers::pi / 180.0;

/// The corner of a living room: the setting of several scenes.
ShellOptions living_room(std::uint64_t seed) {
  const auto s = static_cast<std::uint32_t>(seed);
  ShellOptions shell;
  shell.size = {4.6, 4.0, 2.6};
  shell.floor = parquet(WoodKind::kOak, s);
  shell.walls = {plaster(paint(0xEFEAE0), s + 1), plaster(paint(0xEFEAE0), s + 2),
                 plaster(paint(0x8FA6A3), s + 3), plaster(paint(0xEFEAE0), s + 4)};
  shell.wall_texels_per_m = {420, 220, 420, 220};
  shell.floor_texels_per_m = 380;
  return shell;
}

Vector3d table_size() { return {1.5, 0.9, 0.74}; }
Vector3d table_middle() { return {1.75, 1.55, 0.0}; }

void furnish_table(RoomModel& model, std::uint64_t seed) {
  const Vector3d size = table_size();
  const Place table{table_middle(), 0.0};
  add_table(model, table, size, WoodKind::kWalnut,
            {lay(PrintKind::kMagazine, 1.07, 0.55, 0.21, 0.28, 0.35, seed + 41),
             lay(PrintKind::kPage, 0.28, 0.10, 0.21, 0.297, -0.25, seed + 42)},
            static_cast<std::uint32_t>(seed) + 11);
  const auto at = [&](double x, double y, double yaw) {
    return Place{table.to_world({x, y, size.z()}), yaw};
  };
  // The middle stays free.
  add_book_stack(model, at(-0.56, 0.22, 0.3), 4, seed + 21);
  add_lamp(model, at(-0.60, -0.27, 0.0), 0.46, 0.26, static_cast<std::uint32_t>(seed) + 22);
  add_fruit_bowl(model, at(-0.26, 0.27, 0.0), seed + 23);
  add_mug(model, at(-0.10, -0.33, 0.7), paint(0x3E6F86), 24);
  add_mug(model, at(0.63, -0.04, -1.9), paint(0xC8573F), 25);
  add_plant(model, at(0.22, -0.33, 0.0), 0.12, 11, 0.12, seed + 26);
  add_toy_block(model, at(0.52, -0.33, 0.5), 0.07, seed + 27);
  add_toy_block(model, at(0.62, -0.27, 1.1), 0.055, seed + 28);
  add_pencil(model, table.to_world({-0.24, -0.26, size.z() + 0.0037}),
             table.to_world({-0.15, -0.16, size.z() + 0.0037}), paint(0xE0A526));
  add_pencil(model, table.to_world({-0.40, -0.22, size.z() + 0.0037}),
             table.to_world({-0.28, -0.16, size.z() + 0.0037}), paint(0x2E6DA4));
}

Scene living_room_with_table(std::uint64_t seed) {
  Scene scene;
  RoomModel& model = scene.model;
  ShellOptions shell = living_room(seed);
  shell.floor_decals = {spread_rug(0.65, 0.55, 2.3, 1.9, static_cast<std::uint32_t>(seed))};
  shell.decals[kWallY0] = {hang(PrintKind::kMountains, 2.05, 1.22, 0.70, 0.50, seed + 1),
                           hang(PrintKind::kShapes, 2.95, 1.12, 0.50, 0.70, seed + 2),
                           hang(PrintKind::kBotanical, 3.62, 1.15, 0.42, 0.60, seed + 3)};
  shell.decals[kWallX0] = {hang(PrintKind::kMap, 2.65, 1.05, 0.90, 0.68, seed + 4),
                           hang(PrintKind::kBlocks, 0.22, 1.20, 0.36, 0.36, seed + 5)};
  shell.decals[kWallX1] = {hang(PrintKind::kShapes, 0.40, 1.15, 0.60, 0.80, seed + 51),
                           hang(PrintKind::kMountains, 1.55, 1.25, 1.00, 0.70, seed + 52),
                           hang(PrintKind::kBotanical, 2.95, 1.20, 0.50, 0.70, seed + 53)};
  shell.decals[kWallY1] = {hang(PrintKind::kMap, 0.50, 1.10, 0.90, 0.70, seed + 54),
                           hang(PrintKind::kBlocks, 3.35, 1.15, 0.70, 0.70, seed + 55)};
  add_shell(model, shell);
  model.ambient = Color(0.40F, 0.40F, 0.41F);
  model.exposure = 1.15F;
  add_window(model, shell, kWallX0, 1.05, 0.95, 1.2, 1.30, Color(2.3F, 2.6F, 3.0F), seed + 6);
  model.sun = {sun_direction(-0.80, -0.12, 0.55), Color(2.1F, 1.85F, 1.45F)};
  add_curtain(model, {0.10, 0.70, 2.36}, {0.10, 1.06, 2.36}, 2.3, paint(0xC9BBA2), 8);
  add_curtain(model, {0.10, 2.24, 2.36}, {0.10, 2.60, 2.36}, 2.3, paint(0xC9BBA2), 9);
  add_tube(model, {{0.10, 0.62, 2.38}, {0.10, 2.68, 2.38}}, 0.012, plain(Color::Constant(0.08F)));
  const Place cabinet = against_wall(shell, kWallY0, 2.55, 0.23);
  add_cabinet(model, cabinet, {1.5, 0.42, 0.78}, WoodKind::kPine, 3, 12);
  const auto on_cabinet = [&](double x, double y) {
    return Place{cabinet.to_world({x, y, 0.78}), cabinet.yaw};
  };
  add_book_row(model, on_cabinet(-0.70, 0.06), 0.42, 0.27, 0.18, seed + 13);
  add_vase(model, on_cabinet(0.50, 0.0), paint(0x355C7D), seed + 14);
  add_lamp(model, on_cabinet(0.12, 0.04), 0.42, 0.24, 15);
  add_bookshelf(model, against_wall(shell, kWallY0, 0.95, 0.17), {0.85, 0.30, 1.85},
                WoodKind::kWhite, 5, seed + 16);
  add_plant(model, {{0.42, 0.40, 0}, 0.3}, 0.34, 16, 0.42, seed + 17);
  add_sofa(model, {{0.52, 3.25, 0}, kPi / 2}, 1.35, paint(0x5B7A8C), 18);
  add_chair(model, {{1.55, 0.86, 0}, kPi + 0.12}, WoodKind::kOak, 19);
  add_chair(model, {{0.74, 1.70, 0}, -kPi / 2 + 0.2}, WoodKind::kOak, 20);
  furnish_table(model, seed);
  return scene;
}

}  // namespace

Scene tabletop(std::uint64_t seed) {
  Scene scene = living_room_with_table(seed);
  const Vector3d centre = table_middle();
  scene.path = CameraPath(orbit(centre,
                                {{12, 1.62, 1.42, 0.86},
                                 {28, 1.55, 1.36, 0.84},
                                 {46, 1.45, 1.32, 0.80},
                                 {63, 1.38, 1.40, 0.76},
                                 {78, 1.30, 1.48, 0.74},
                                 {70, 1.18, 1.40, 0.74},
                                 {54, 1.25, 1.26, 0.80}},
                                10.0 / 6.0),
                          {}, named_seed("tabletop path", seed));
  return scene;
}

/// A whole room; the camera walks around the table and comes back to where it began.
Scene room(std::uint64_t seed) {
  Scene scene = living_room_with_table(seed);
  RoomModel& model = scene.model;
  ShellOptions shell = living_room(seed);
  add_cabinet(model, against_wall(shell, kWallX1, 1.4, 0.25), {1.1, 0.45, 0.95}, WoodKind::kOak, 2,
              31);
  add_book_stack(model, {{4.36, 2.75, 0.95}, 1.2}, 3, seed + 32);
  add_bookshelf(model, against_wall(shell, kWallY1, 2.4, 0.17), {1.0, 0.30, 1.6}, WoodKind::kOak, 4,
                seed + 33);
  add_plant(model, {{4.15, 3.55, 0}, 0.3}, 0.36, 14, 0.40, seed + 34);
  std::vector<PathKey> keys;
  const Vector3d middle(2.75, 2.60, 0.0);
  constexpr int kSteps = 16;
  for (int i = 0; i <= kSteps; ++i) {
    // Around the free part of the room, looking across it; the end repeats the beginning.
    const double a = 2.0 * kPi * i / kSteps + 0.9;
    PathKey key;
    key.time_s = 30.0 * i / kSteps;
    key.eye = middle + Vector3d(1.10 * std::cos(a), 0.85 * std::sin(a), 1.50);
    key.target = middle - Vector3d(1.6 * std::cos(a + 0.25), 1.6 * std::sin(a + 0.25), -0.90);
    keys.push_back(key);
  }
  scene.path = CameraPath(keys, {0.010, 0.45, 0.6, 0.012, 1.7}, named_seed("room path", seed));
  return scene;
}

/// Three seconds of turning on the spot before the first step.
Scene rotation_start(std::uint64_t seed) {
  Scene scene = living_room_with_table(seed);
  const Vector3d eye(3.15, 2.75, 1.45);
  const Vector3d table = table_middle() + Vector3d(0, 0, 0.8);
  const auto turned = [&](double degrees) -> Vector3d {
    return eye + Eigen::AngleAxisd(degrees * kRadians, Vector3d::UnitZ()) * (table - eye);
  };
  std::vector<PathKey> keys = {{0.0, eye, turned(-14)},
                               {0.8, eye, turned(-3)},
                               {1.6, eye, turned(10)},
                               {2.4, eye, turned(2)},
                               {3.2, eye, turned(0)}};
  keys.push_back({4.4, eye + Vector3d(-0.30, 0.25, -0.05), table});
  keys.push_back({5.6, eye + Vector3d(-0.75, 0.40, -0.08), table});
  keys.push_back({6.8, eye + Vector3d(-1.15, 0.45, 0.0), table});
  keys.push_back({8.0, eye + Vector3d(-0.85, 0.30, -0.1), table});
  // A wandering hand would give away the parallax: at the start it only turns.
  scene.path = CameraPath(keys, {0.0005, 0.3, 0.4, 0.0, 1.8}, named_seed("rotation path", seed));
  return scene;
}

/// The tabletop in the evening, by its lamps alone: little light, so a long shutter and much noise.
Scene dark_room(std::uint64_t seed) {
  static constexpr float kNight = 0.015F;  // of the light that comes in by day
  Scene scene = tabletop(seed);
  RoomModel& model = scene.model;
  for (WindowLight& window : model.windows) window.radiance *= kNight;
  for (Patch& patch : model.patches) {
    if (!patch.shines || patch.label == 0) continue;  // lamp shades go on shining
    const Texture day = patch.texture;
    patch.texture = [day](float u, float v) -> Color { return kNight * day(u, v); };
  }
  model.sun.radiance = Color::Zero();
  model.ambient = Color(0.05F, 0.045F, 0.04F);
  model.exposure = 1.3F;
  scene.effects.noise_sigma = 6.5;
  scene.effects.vignetting = 0.35;
  scene.effects.exposure_drift = 0.12;
  scene.effects.shutter_s = 0.020;
  return scene;
}

/// The tabletop with the lens covered for a second and a half.
Scene tracking_loss(std::uint64_t seed) {
  Scene scene = tabletop(seed);
  scene.covered_s = {{4.5, 6.0}};
  return scene;
}

}  // namespace planecast::engine::synth
