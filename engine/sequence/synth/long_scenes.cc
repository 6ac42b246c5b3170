#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "engine/sequence/synth/furniture.h"
#include "engine/sequence/synth/random.h"
#include "engine/sequence/synth/room_shell.h"
#include "engine/sequence/synth/scene_parts.h"

/// Scenes whose camera comes back to where it was.
namespace planecast::engine::synth {

using Eigen::Vector3d;

namespace {

constexpr double kPi = std::numbers::pi;

// The corridor around a square block: outer side, and where the block begins and ends.
constexpr double kOuter = 6.0;
constexpr double kBlockLow = 1.7;
constexpr double kBlockHigh = kOuter - kBlockLow;
constexpr double kHeight = 2.5;

constexpr PrintKind kPrints[] = {PrintKind::kShapes, PrintKind::kMountains, PrintKind::kMap,
                                 PrintKind::kBlocks, PrintKind::kBotanical};

/// Every print of the corridor is another one, so that no two places look alike.
std::vector<Decal> corridor_decals(double length, const Texture& door, std::uint64_t seed) {
  Random random(seed);
  std::vector<Decal> decals;
  const double door_u = random.uniform(0.15, 0.45) * length;
  const auto upright = [door](float u, float v) { return door(v, u); };
  decals.push_back({static_cast<float>(door_u), 0.0F, 0.85F, 2.05F, upright, 0.03F, 0.0F});
  const int places = static_cast<int>(std::lround(1.4 * length));
  for (int i = 0; i < places; ++i) {
    const double width = random.uniform(0.32, 0.58);
    const double u = 0.15 + (length - 0.6) * i / places + random.uniform(0.0, 0.08);
    if (u + width > door_u - 0.05 && u < door_u + 0.9) continue;
    decals.push_back(hang(kPrints[(i + seed) % 5], u, random.uniform(0.8, 1.35), width,
                          width * random.uniform(0.8, 1.3), seed + 17U * i));
  }
  return decals;
}

/// Faces of the block that the corridor goes around.
void add_block(RoomModel& model, const Texture& door, std::uint64_t seed) {
  const double side = kBlockHigh - kBlockLow;
  const Vector3d corners[] = {{kBlockLow, kBlockLow, 0},
                              {kBlockHigh, kBlockLow, 0},
                              {kBlockHigh, kBlockHigh, 0},
                              {kBlockLow, kBlockHigh, 0}};
  for (int i = 0; i < 4; ++i) {
    const Vector3d along = (corners[(i + 1) % 4] - corners[i]).normalized() * side;
    const Texture wall = plaster(paint(i % 2 == 0 ? 0xD8C3A5 : 0xB9C4C9),
                                 static_cast<std::uint32_t>(seed) + 40U + i);
    add_flat(model, corners[i], along, {0, 0, kHeight},
             with_decals(wall, corridor_decals(side, door, seed + 101U * i)),
             {"wall", 360.0F, 0.05F});
  }
}

/// Point on a square with rounded corners around the block, at the arc length `s` from the middle
/// of the first side.
Vector3d on_ring(double s) {
  constexpr double kRadius = 0.75;
  constexpr double kInset = 0.5 * kBlockLow;
  const double straight = kOuter - 2.0 * kInset - 2.0 * kRadius;
  const double quarter = straight + 0.5 * kPi * kRadius;
  s += 0.5 * straight;
  const double turns = std::floor(s / quarter);
  s -= turns * quarter;
  const double half = 0.5 * kOuter - kInset;
  Vector3d local;  // along the lower side, the ring's middle at the origin
  if (s < straight) {
    local = Vector3d(-0.5 * straight + s, -half, 0);
  } else {
    const double angle = (s - straight) / kRadius;
    local = Vector3d(0.5 * straight + kRadius * std::sin(angle),
                     -half + kRadius * (1.0 - std::cos(angle)), 0);
  }
  return Vector3d(0.5 * kOuter, 0.5 * kOuter, 0) +
         Eigen::AngleAxisd(0.5 * kPi * turns, Vector3d::UnitZ()) * local;
}

double ring_length() {
  constexpr double kRadius = 0.75;
  return 4.0 * (kOuter - kBlockLow - 2.0 * kRadius + 0.5 * kPi * kRadius);
}

ShellOptions corridor_shell(std::uint64_t seed) {
  const auto s = static_cast<std::uint32_t>(seed);
  ShellOptions shell;
  shell.size = {kOuter, kOuter, kHeight};
  shell.floor = tiles(paint(0xB4AB9C), paint(0x6F6A60), 0.45F, s);
  shell.floor_texels_per_m = 260;
  shell.wall_texels_per_m = {330, 330, 330, 330};
  const Texture door = furniture_wood(WoodKind::kWalnut, s + 5);
  for (const Wall wall : {kWallX0, kWallX1, kWallY0, kWallY1}) {
    const auto w = static_cast<std::uint32_t>(wall);
    shell.walls[wall] = plaster(paint(w % 2 == 0 ? 0xE4DCCB : 0xCFD8D2), s + 10 + w);
    shell.decals[wall] = corridor_decals(kOuter, door, seed + 1009U * (w + 1));
  }
  shell.floor_decals = {spread_rug(2.0, 0.35, 1.6, 0.9, s + 1),
                        spread_rug(4.75, 2.4, 0.9, 1.5, s + 2)};
  return shell;
}

}  // namespace

/// Once around a block and two metres on: only the recognised beginning closes the loop, since no
/// place is seen again before.
Scene ring_corridor(std::uint64_t seed) {
  Scene scene;
  RoomModel& model = scene.model;
  const auto s = static_cast<std::uint32_t>(seed);
  add_shell(model, corridor_shell(seed));
  add_block(model, furniture_wood(WoodKind::kOak, s + 6), seed + 7);
  for (int i = 0; i < 4; ++i) {
    LampLight lamp;
    const Vector3d at = on_ring(0.25 * ring_length() * (i + 0.5));
    lamp.position = Eigen::Vector3d(at.x(), at.y(), 2.3).cast<float>();
    lamp.radius_m = 0.12F;
    lamp.intensity = Color(1.6F, 1.45F, 1.2F);
    model.lamps.push_back(lamp);
  }
  model.exposure = 1.2F;
  add_plant(model, {{0.45, 0.45, 0}, 0}, 0.30, 12, 0.32, seed + 9);
  add_cabinet(model, {{5.75, 3.4, 0}, -0.5 * kPi}, {0.9, 0.32, 0.85}, WoodKind::kOak, 2, s + 8);
  add_plant(model, {{5.5, 5.5, 0}, 0}, 0.34, 14, 0.36, seed + 11);
  add_book_stack(model, {{5.75, 3.5, 0.85}, 0.4}, 4, seed + 12);
  add_chair(model, {{0.45, 5.4, 0}, 0.8}, WoodKind::kPine, s + 13);
  constexpr double kSpeed = 0.55;
  constexpr double kAhead = 1.7;
  const double way = ring_length() + 2.0;
  std::vector<PathKey> keys;
  const int steps = static_cast<int>(way / 0.5);
  for (int i = 0; i <= steps; ++i) {
    const double at = way * i / steps;
    keys.push_back({at / kSpeed, on_ring(at) + Vector3d(0, 0, 1.5),
                    on_ring(at + kAhead) + Vector3d(0, 0, 1.25)});
  }
  scene.path = CameraPath(keys, {0.012, 0.5, 0.6, 0.012, 1.8}, named_seed("ring path", seed));
  return scene;
}

/// The room, walked around lap by lap, each a little different, for as many frames as are asked
/// for; by default 100 s.
Scene revisited_room(std::uint64_t seed) {
  constexpr double kLap_s = 30.0;
  constexpr double kDefault_s = 100.0;
  constexpr int kSteps = 16;
  constexpr int kLaps = 120;
  Scene scene = room(seed);
  const Vector3d middle(2.75, 2.60, 0.0);
  std::vector<PathKey> keys;
  for (int i = 0; i <= kLaps * kSteps; ++i) {
    const int lap = i / kSteps;
    const double a = 2.0 * kPi * i / kSteps + 0.9;
    const double reach = 1.0 - 0.10 * (lap % 3);
    const double eye_height = 1.5 - 0.12 * (lap % 2);
    keys.push_back(
        {kLap_s * i / kSteps,
         middle + Vector3d(1.10 * reach * std::cos(a), 0.85 * reach * std::sin(a), eye_height),
         middle - Vector3d(1.6 * std::cos(a + 0.25), 1.6 * std::sin(a + 0.25), -0.90)});
  }
  scene.path = CameraPath(keys, {0.010, 0.45, 0.6, 0.012, 1.7}, named_seed("revisit path", seed),
                          kDefault_s);
  return scene;
}

}  // namespace planecast::engine::synth
