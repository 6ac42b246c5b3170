#include "engine/sequence/synth/scenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "engine/sequence/synth/furniture.h"
#include "engine/sequence/synth/random.h"
#include "engine/sequence/synth/room_shell.h"
#include "engine/sequence/synth/scene_parts.h"

namespace planecast::engine::synth {

namespace {

using Eigen::Vector3d;

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
                                {{20, 2.3, 1.45, 0.75},
                                 {35, 2.2, 1.40, 0.70},
                                 {52, 2.1, 1.35, 0.80},
                                 {66, 2.2, 1.50, 0.85},
                                 {50, 1.9, 1.45, 0.70},
                                 {32, 1.9, 1.35, 0.75}},
                                1.8),
                          {}, named_seed("corner path", seed));
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
                                {{200, 1.3, 1.5, 0},
                                 {230, 1.2, 1.4, 0},
                                 {262, 1.1, 1.3, 0},
                                 {295, 1.2, 1.5, 0},
                                 {320, 1.0, 1.6, 0}},
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
  add_chair(model, {{1.7, 0.72, 0}, std::numbers::pi}, WoodKind::kWhite, s + 7);
  add_cabinet(model, against_wall(shell, kWallX0, 0.6, 0.23), {0.8, 0.42, 0.7}, WoodKind::kWhite, 2,
              s + 8);
  scene.path = CameraPath(orbit({1.5, 1.2, 0},
                                {{15, 1.7, 1.45, 0.8},
                                 {35, 1.6, 1.4, 0.8},
                                 {55, 1.5, 1.45, 0.8},
                                 {72, 1.5, 1.4, 0.8},
                                 {50, 1.4, 1.35, 0.8}},
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
                                {{62, 2.1, 1.6, 0.55},
                                 {80, 2.0, 1.5, 0.55},
                                 {100, 1.9, 1.6, 0.6},
                                 {118, 2.0, 1.7, 0.6},
                                 {95, 1.8, 1.5, 0.6}},
                                2.2),
                          {}, named_seed("stair path", seed));
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
    {"dark-room", dark_room},
    {"ring", ring_corridor},
    {"revisit", revisited_room},
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
