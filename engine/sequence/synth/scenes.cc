#include "engine/sequence/synth/scenes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "engine/sequence/synth/furniture.h"
#include "engine/sequence/synth/random.h"
#include "engine/sequence/synth/room_shell.h"

namespace planecast::engine::synth {

namespace {

using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;
constexpr double kRadians = kPi / 180.0;

Color paint(std::uint32_t rgb) { return color_from_srgb(rgb); }

Decal hang(PrintKind kind, double u, double v, double width, double height, std::uint64_t seed) {
  return {static_cast<float>(u),
          static_cast<float>(v),
          static_cast<float>(width),
          static_cast<float>(height),
          print(kind, width, height, seed),
          0.012F,
          0.0F};
}

Decal lay(PrintKind kind, double u, double v, double width, double height, double yaw,
          std::uint64_t seed) {
  Decal decal = hang(kind, u, v, width, height, seed);
  decal.shadow_m = 0.004F;
  decal.yaw = static_cast<float>(yaw);
  return decal;
}

Decal spread_rug(double u, double v, double width, double height, std::uint32_t seed) {
  const auto w = static_cast<float>(width);
  const auto h = static_cast<float>(height);
  return {static_cast<float>(u), static_cast<float>(v), w, h, rug(w, h, seed), 0.015F, 0.0F};
}

Eigen::Vector3f sun_direction(double x, double y, double z) {
  return Vector3d(x, y, z).normalized().cast<float>();
}

/// Keys on an arc about `centre`: azimuth and height go from one value to the next.
std::vector<PathKey> orbit(const Vector3d& centre, const std::vector<std::array<double, 4>>& steps,
                           double step_s) {
  std::vector<PathKey> keys;
  for (const auto& [azimuth_deg, radius, height, look_height] : steps) {
    const double a = azimuth_deg * kRadians;
    PathKey key;
    key.time_s = step_s * static_cast<double>(keys.size());
    key.eye =
        Vector3d(centre.x() + radius * std::cos(a), centre.y() + radius * std::sin(a), height);
    key.target = Vector3d(centre.x(), centre.y(), look_height);
    keys.push_back(key);
  }
  return keys;
}

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

Scene tabletop(std::uint64_t seed) {
  Scene scene = living_room_with_table(seed);
  const Vector3d centre = table_middle();
  scene.path = CameraPath(orbit(centre,
                                {{{12, 1.62, 1.42, 0.86}},
                                 {{28, 1.55, 1.36, 0.84}},
                                 {{46, 1.45, 1.32, 0.80}},
                                 {{63, 1.38, 1.40, 0.76}},
                                 {{78, 1.30, 1.48, 0.74}},
                                 {{70, 1.18, 1.40, 0.74}},
                                 {{54, 1.25, 1.26, 0.80}}},
                                10.0 / 6.0),
                          {}, named_seed("tabletop path", seed));
  return scene;
}

Scene corner(std::uint64_t seed) {
  Scene scene;
  RoomModel& model = scene.model;
  const auto s = static_cast<std::uint32_t>(seed);
  ShellOptions shell;
  shell.size = {4.0, 3.6, 2.7};
  shell.floor = tiles(paint(0xCBB49A), paint(0x6E645A), 0.33F, s);
  shell.walls[kWallX0] = bricks(paint(0xA85C44), paint(0xCFC6B8), s + 1);
  shell.walls[kWallY0] = plaster(paint(0xE6DCC8), s + 2);
  shell.walls[kWallX1] = plaster(paint(0xE9E4DA), s + 3);
  shell.walls[kWallY1] = plaster(paint(0xE9E4DA), s + 4);
  shell.wall_texels_per_m = {480, 150, 480, 150};
  shell.decals[kWallX0] = {hang(PrintKind::kShapes, 0.55, 1.00, 0.60, 0.84, seed + 1),
                           hang(PrintKind::kMountains, 1.50, 1.15, 0.80, 0.56, seed + 2)};
  shell.decals[kWallY0] = {hang(PrintKind::kMap, 1.75, 1.00, 0.95, 0.72, seed + 3),
                           hang(PrintKind::kBotanical, 2.95, 0.95, 0.50, 0.70, seed + 4),
                           hang(PrintKind::kBlocks, 3.55, 1.45, 0.30, 0.30, seed + 5)};
  shell.floor_decals = {spread_rug(0.45, 0.40, 1.7, 1.2, s + 1)};
  add_shell(model, shell);
  add_window(model, shell, kWallY1, 1.2, 0.9, 1.6, 1.4, Color(2.6F, 2.8F, 3.1F), seed + 6);
  model.sun = {sun_direction(0.25, 0.8, 0.55), Color(1.8F, 1.6F, 1.3F)};
  add_plant(model, {{0.36, 0.36, 0}, 0.0}, 0.30, 13, 0.34, seed + 7);
  add_toy_block(model, {{0.95, 0.75, 0}, 0.4}, 0.17, seed + 8);
  add_toy_block(model, {{1.20, 0.62, 0}, 1.0}, 0.13, seed + 9);
  add_book_stack(model, {{1.62, 0.42, 0}, 0.5}, 4, seed + 10);
  scene.path = CameraPath(orbit({0.75, 0.65, 0},
                                {{{20, 2.3, 1.45, 0.75}},
                                 {{35, 2.2, 1.40, 0.70}},
                                 {{52, 2.1, 1.35, 0.80}},
                                 {{66, 2.2, 1.50, 0.85}},
                                 {{50, 1.9, 1.45, 0.70}},
                                 {{32, 1.9, 1.35, 0.75}}},
                                1.8),
                          {}, named_seed("corner path", seed));
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

Scene one_plane(std::uint64_t seed) {
  Scene scene;
  const auto s = static_cast<std::uint32_t>(seed);
  ShellOptions shell;
  shell.size = {6.0, 6.0, 2.6};
  shell.floor = carpet(paint(0x6E7F8A), paint(0xB9B2A0), s);
  shell.floor_decals = {spread_rug(2.0, 2.1, 2.0, 1.4, s),
                        lay(PrintKind::kMagazine, 2.3, 3.7, 0.42, 0.56, 0.3, seed + 1),
                        lay(PrintKind::kMap, 3.4, 3.65, 0.8, 0.6, -0.2, seed + 2),
                        lay(PrintKind::kShapes, 1.4, 1.3, 0.5, 0.7, 0.7, seed + 3),
                        lay(PrintKind::kPage, 3.6, 1.4, 0.42, 0.6, -0.5, seed + 4)};
  shell.ceiling = false;
  shell.skirting = false;
  shell.floor_texels_per_m = 340;
  add_shell(scene.model, shell);
  scene.model.ambient = Color(0.9F, 0.92F, 0.95F);
  scene.path = CameraPath(orbit({3, 3, 0},
                                {{{200, 1.3, 1.5, 0}},
                                 {{230, 1.2, 1.4, 0}},
                                 {{262, 1.1, 1.3, 0}},
                                 {{295, 1.2, 1.5, 0}},
                                 {{320, 1.0, 1.6, 0}}},
                                2.0),
                          {}, named_seed("plane path", seed));
  return scene;
}

/// Plain walls and floor, few things: what trackers lose themselves in.
Scene plain_room(std::uint64_t seed) {
  Scene scene;
  RoomModel& model = scene.model;
  const auto s = static_cast<std::uint32_t>(seed);
  ShellOptions shell;
  shell.size = {4.4, 3.8, 2.6};
  shell.floor = plaster(paint(0xB8B2A8), s + 9);
  shell.walls = {plaster(paint(0xF0EEE9), s), plaster(paint(0xF0EEE9), s + 1),
                 plaster(paint(0xE9E7E1), s + 2), plaster(paint(0xF0EEE9), s + 3)};
  shell.decals[kWallY0] = {hang(PrintKind::kMountains, 2.2, 1.1, 0.7, 0.5, seed + 1)};
  add_shell(model, shell);
  add_window(model, shell, kWallX0, 1.3, 0.95, 1.2, 1.3, Color(2.6F, 2.8F, 3.1F), seed + 2);
  add_table(model, {{1.6, 1.3, 0}, 0.1}, {1.3, 0.8, 0.74}, WoodKind::kWhite, {}, s + 4);
  add_mug(model, {{1.4, 1.2, 0.74}, 0.3}, paint(0xC8573F), 5);
  add_book_stack(model, {{1.85, 1.4, 0.74}, 0.4}, 3, seed + 6);
  add_chair(model, {{1.7, 0.72, 0}, kPi}, WoodKind::kWhite, s + 7);
  add_cabinet(model, against_wall(shell, kWallX0, 0.6, 0.23), {0.8, 0.42, 0.7}, WoodKind::kWhite, 2,
              s + 8);
  scene.path = CameraPath(orbit({1.5, 1.2, 0},
                                {{{15, 1.7, 1.45, 0.8}},
                                 {{35, 1.6, 1.4, 0.8}},
                                 {{55, 1.5, 1.45, 0.8}},
                                 {{72, 1.5, 1.4, 0.8}},
                                 {{50, 1.4, 1.35, 0.8}}},
                                2.5),
                          {}, named_seed("plain path", seed));
  return scene;
}

Scene corridor(std::uint64_t seed) {
  Scene scene;
  RoomModel& model = scene.model;
  const auto s = static_cast<std::uint32_t>(seed);
  ShellOptions shell;
  shell.size = {10.0, 1.9, 2.5};
  shell.floor = tiles(paint(0xB9B4A6), paint(0x7A756B), 0.4F, s);
  shell.floor_texels_per_m = 200;
  shell.walls = {plaster(paint(0xD9C9A8), s), plaster(paint(0xE8E4DB), s + 1),
                 plaster(paint(0xE8E4DB), s + 2), plaster(paint(0xDDE2DE), s + 3)};
  shell.wall_texels_per_m = {400, 200, 204, 204};
  const Texture door = furniture_wood(WoodKind::kWalnut, s + 5);
  const auto upright = [door](float u, float v) { return door(v, u); };
  const PrintKind kinds[] = {PrintKind::kShapes, PrintKind::kMountains, PrintKind::kMap,
                             PrintKind::kBlocks, PrintKind::kBotanical};
  for (const Wall wall : {kWallY0, kWallY1}) {
    for (int i = 0; i < 3; ++i) {
      const double u = 0.8 + 3.1 * i + (wall == kWallY0 ? 0.6 : 0.0);
      shell.decals[wall].push_back(
          {static_cast<float>(u), 0.0F, 0.9F, 2.05F, upright, 0.03F, 0.0F});
      shell.decals[wall].push_back(
          hang(kinds[(i + 2 * wall) % 5], u + 1.25, 1.1, 0.55, 0.70, seed + 10U * i + wall));
    }
  }
  shell.decals[kWallX0] = {hang(PrintKind::kShapes, 0.55, 0.9, 0.8, 1.12, seed + 60)};
  add_shell(model, shell);
  for (int i = 0; i < 4; ++i) {
    LampLight lamp;
    lamp.position = Eigen::Vector3f(1.2F + 2.5F * static_cast<float>(i), 0.95F, 2.35F);
    lamp.radius_m = 0.12F;
    lamp.intensity = Color(1.5F, 1.35F, 1.1F);
    model.lamps.push_back(lamp);
  }
  model.exposure = 1.2F;
  add_cabinet(model, against_wall(shell, kWallY0, 5.9, 0.18), {1.0, 0.32, 0.85}, WoodKind::kOak, 3,
              s + 8);
  add_plant(model, {{1.0, 0.40, 0}, 0}, 0.30, 12, 0.32, seed + 9);
  add_plant(model, {{6.6, 1.55, 0}, 0}, 0.30, 12, 0.32, seed + 11);
  std::vector<PathKey> keys;
  for (int i = 0; i <= 8; ++i) {
    keys.push_back({1.6 * i, Vector3d(9.2 - 0.72 * i, 0.95 + 0.12 * std::sin(1.1 * i), 1.5),
                    Vector3d(5.6 - 0.72 * i, 0.95 - 0.35 * std::sin(0.9 * i), 1.05)});
  }
  scene.path = CameraPath(keys, {0.012, 0.5, 0.6, 0.015, 1.8}, named_seed("corridor path", seed));
  return scene;
}

/// Steps that rise towards -y up to a landing at `corner`, 1.6 m wide. Treads and risers are planes
/// of their own; each side is one plane with the outline of the stair.
void add_steps(RoomModel& model, const Vector3d& corner, int count, const Texture& tread,
               const Texture& riser) {
  constexpr double kWidth = 1.6;
  constexpr double kDepth = 0.29;
  constexpr double kRise = 0.175;
  constexpr double kLanding = 0.6;
  const Vector3d across(kWidth, 0, 0);
  std::array<std::vector<Vector3d>, 2> outline = {
      {{corner, corner + Vector3d(0, 0, count * kRise)},
       {corner + across, corner + across + Vector3d(0, 0, count * kRise)}}};
  std::array<std::vector<int>, 2> side_patches;
  for (int i = count - 1; i >= 0; --i) {  // from the landing down
    const int below = count - 1 - i;
    const double back = below == 0 ? 0.0 : kLanding + kDepth * (below - 1);
    const double front = kLanding + kDepth * below;
    const double top = kRise * (i + 1);
    add_flat(model, corner + Vector3d(0, back, top), across, {0, front - back, 0}, tread,
             {"", 500.0F, 0.02F});
    add_flat(model, corner + Vector3d(kWidth, front, top - kRise), -across, {0, 0, kRise}, riser,
             {"", 400.0F, 0.02F});
    side_patches[0].push_back(add_flat(model, corner + Vector3d(0, front, 0), {0, back - front, 0},
                                       {0, 0, top}, riser, {"none", 300.0F, 0.04F}));
    side_patches[1].push_back(add_flat(model, corner + across + Vector3d(0, back, 0),
                                       {0, front - back, 0}, {0, 0, top}, riser,
                                       {"none", 300.0F, 0.04F}));
    for (std::size_t side = 0; side < 2; ++side) {
      const Vector3d foot = corner + static_cast<double>(side) * across;
      outline[side].push_back(foot + Vector3d(0, front, top));
      outline[side].push_back(foot + Vector3d(0, front, top - kRise));
    }
  }
  for (std::size_t side = 0; side < 2; ++side) {
    TruePlane plane;
    plane.label = static_cast<int>(model.planes.size()) + 1;
    plane.plane_class = "vertical";
    plane.normal = side == 0 ? Vector3d(-Vector3d::UnitX()) : Vector3d(Vector3d::UnitX());
    plane.offset = -plane.normal.dot(outline[side][0]);
    plane.polygon = outline[side];
    // The outline goes up at the wall and down the steps: counter-clockwise seen from -x.
    if (side == 1) std::reverse(plane.polygon.begin(), plane.polygon.end());
    for (const int patch : side_patches[side]) {
      Patch& strip = model.patches[static_cast<std::size_t>(patch)];
      strip.label = plane.label;
      plane.area += static_cast<double>(strip.width_m) * strip.height_m;
    }
    model.planes.push_back(plane);
  }
}

/// Parallel planes at small distances.
Scene stair(std::uint64_t seed) {
  Scene scene;
  RoomModel& model = scene.model;
  const auto s = static_cast<std::uint32_t>(seed);
  ShellOptions shell;
  shell.size = {3.6, 4.2, 3.4};
  shell.floor = tiles(paint(0xA9A296), paint(0x5F5A52), 0.3F, s);
  shell.walls = {plaster(paint(0xE9DFCB), s), plaster(paint(0xE9DFCB), s + 1),
                 bricks(paint(0x9C6A50), paint(0xC9C0B2), s + 2), plaster(paint(0xE9DFCB), s + 3)};
  shell.wall_texels_per_m = {400, 400, 400, 120};
  shell.decals[kWallX0] = {hang(PrintKind::kMountains, 2.5, 1.2, 0.8, 0.56, seed + 1)};
  shell.decals[kWallX1] = {hang(PrintKind::kBotanical, 1.2, 1.2, 0.5, 0.7, seed + 2)};
  add_shell(model, shell);
  add_window(model, shell, kWallY1, 1.0, 1.2, 1.4, 1.3, Color(3.0F, 3.1F, 3.3F), seed + 3);
  const Texture tread = furniture_wood(WoodKind::kOak, s + 4);
  const Texture riser = plaster(paint(0xE6E0D4), s + 5);
  add_steps(model, {1.0, 0.0, 0.0}, 6, tread, riser);
  add_plant(model, {{0.5, 2.4, 0}, 0}, 0.32, 13, 0.36, seed + 6);
  add_toy_block(model, {{1.35, 1.88, 0.175}, 0.4}, 0.14, seed + 7);
  add_book_stack(model, {{2.2, 1.31, 0.525}, 0.4}, 3, seed + 8);
  scene.path = CameraPath(orbit({1.8, 1.2, 0},
                                {{{62, 2.1, 1.6, 0.55}},
                                 {{80, 2.0, 1.5, 0.55}},
                                 {{100, 1.9, 1.6, 0.6}},
                                 {{118, 2.0, 1.7, 0.6}},
                                 {{95, 1.8, 1.5, 0.6}}},
                                2.2),
                          {}, named_seed("stair path", seed));
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

/// The tabletop with the lens covered for a second and a half.
Scene tracking_loss(std::uint64_t seed) {
  Scene scene = tabletop(seed);
  scene.covered_s = {{4.5, 6.0}};
  return scene;
}

struct NamedScene {
  const char* name;
  Scene (*make)(std::uint64_t seed);
};

constexpr NamedScene kScenes[] = {
    {"tabletop", tabletop},
    {"corner", corner},
    {"room", room},
    {"plane", one_plane},
    {"plain-room", plain_room},
    {"corridor", corridor},
    {"stair", stair},
    {"rotation-start", rotation_start},
    {"tracking-loss", tracking_loss},
};

}  // namespace

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const NamedScene& scene : kScenes) names.emplace_back(scene.name);
  return names;
}

std::optional<Scene> make_scene(const std::string& name, std::uint64_t seed) {
  for (const NamedScene& scene : kScenes) {
    if (name == scene.name) return scene.make(named_seed("scene", seed) >> 32);
  }
  return std::nullopt;
}

}  // namespace planecast::engine::synth
