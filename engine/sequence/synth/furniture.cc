#include "engine/sequence/synth/furniture.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "engine/sequence/synth/furniture_parts.h"
#include "engine/sequence/synth/random.h"

namespace planecast::engine::synth {

using Eigen::Vector3d;

namespace {

constexpr double kPi = std::numbers::pi;

WoodOptions wood_options(WoodKind kind) {
  WoodOptions options;
  switch (kind) {
    case WoodKind::kOak:
      options.light = color_from_srgb(0xD9B586);
      options.dark = color_from_srgb(0xA97B49);
      break;
    case WoodKind::kWalnut:
      options.light = color_from_srgb(0x9A6B45);
      options.dark = color_from_srgb(0x573620);
      break;
    case WoodKind::kPine:
      options.light = color_from_srgb(0xE8CFA2);
      options.dark = color_from_srgb(0xC79B62);
      break;
    case WoodKind::kWhite:
      options.light = color_from_srgb(0xEDE9E1);
      options.dark = color_from_srgb(0xDDD7CC);
      options.variation = 0.02F;
      break;
  }
  return options;
}

/// Doors or drawers side by side, with dark joints and round knobs.
Texture door_front(const Texture& panel, double width, double height, int doors) {
  const auto door = static_cast<float>(width / doors);
  const auto top = static_cast<float>(height);
  return [=](float u, float v) -> Color {
    const float x = u - std::floor(u / door) * door;
    const float rim = std::min({x, door - x, v, top - v});
    const bool opens_right = static_cast<int>(u / door) % 2 == 0;
    const float knob_x = opens_right ? door - 0.05F : 0.05F;
    const float knob = std::hypot(x - knob_x, v - 0.62F * top);
    Color color = panel(u, v);
    if (rim < 0.004F) return color * 0.25F;
    if (rim > 0.055F && rim < 0.060F) color *= 0.72F;
    if (rim > 0.060F && rim < 0.063F) color *= 1.12F;
    if (knob < 0.014F) return Color(0.30F, 0.24F, 0.14F) * (1.6F - 60.0F * knob);
    if (knob < 0.022F) color *= 0.6F;
    return color;
  };
}

/// A pillow: an ellipsoid whose sections are rounded rectangles.
void add_cushion(RoomModel& model, const Place& place, const Vector3d& size, double squareness,
                 const Texture& texture) {
  constexpr int kCols = 24;
  constexpr int kRows = 10;
  const auto power = [squareness](double x) {
    return std::copysign(std::pow(std::abs(x), squareness), x);  // 0 at the poles: closed
  };
  std::vector<Vector3d> points;
  for (int j = 0; j <= kRows; ++j) {
    const double polar = kPi * (static_cast<double>(j) / kRows - 0.5);
    for (int i = 0; i <= kCols; ++i) {
      const double around = 2.0 * kPi * i / kCols;
      const Vector3d local(0.5 * size.x() * power(std::cos(polar)) * power(std::cos(around)),
                           0.5 * size.y() * power(std::cos(polar)) * power(std::sin(around)),
                           0.5 * size.z() * (1.0 + power(std::sin(polar))));
      points.push_back(place.to_world(local));
    }
  }
  add_sheet(model, kCols, kRows, points, texture, static_cast<float>(size.x() + size.y()),
            static_cast<float>(size.z() + size.y()), 300.0F);
}

}  // namespace

Texture furniture_wood(WoodKind kind, std::uint32_t seed) {
  WoodOptions options = wood_options(kind);
  options.board_width_m = 0.14F;
  options.board_length_m = 4.0F;
  return wood(options, seed);
}

Texture parquet(WoodKind kind, std::uint32_t seed) {
  WoodOptions options = wood_options(kind);
  options.board_width_m = 0.13F;
  options.board_length_m = 1.15F;
  options.gap_m = 0.003F;
  options.variation = 0.35F;
  return wood(options, seed);
}

Texture print(PrintKind kind, double width_m, double height_m, std::uint64_t seed) {
  constexpr double kTexels = 1000.0;
  return picture(draw_print(kind, std::max(16, static_cast<int>(width_m * kTexels)),
                            std::max(16, static_cast<int>(height_m * kTexels)), seed),
                 static_cast<float>(width_m), static_cast<float>(height_m));
}

void add_table(RoomModel& model, const Place& place, const Vector3d& size, WoodKind wood_kind,
               std::vector<Decal> top_decals, std::uint32_t seed) {
  constexpr double kBoard = 0.032;
  constexpr double kLeg = 0.06;
  const Texture wood_texture = furniture_wood(wood_kind, seed);
  const Place board = on(place, {0, 0, size.z() - kBoard});
  add_box(model, board, {size.x(), size.y(), kBoard}, BoxTextures::all(wood_texture),
          furniture_faces(), true);
  // The top, added before the underside, is what is looked at.
  Patch& top = model.patches[model.patches.size() - 2];
  top.texture = with_decals(wood_texture, std::move(top_decals));
  top.texels_per_m = 950.0F;
  top.light_texel_m = 0.014F;
  const double x = 0.5 * size.x() - 0.05 - 0.5 * kLeg;
  const double y = 0.5 * size.y() - 0.05 - 0.5 * kLeg;
  const auto upright = [wood_texture](float u, float v) { return wood_texture(v, u); };
  for (const Vector3d& foot :
       {Vector3d(-x, -y, 0), Vector3d(x, -y, 0), Vector3d(x, y, 0), Vector3d(-x, y, 0)}) {
    add_box(model, on(place, foot), {kLeg, kLeg, size.z() - kBoard}, BoxTextures::all(upright),
            small_things());
  }
  constexpr double kApron = 0.07;
  for (const double s : {-1.0, 1.0}) {
    add_box(model, on(place, {0, s * y, size.z() - kBoard - kApron}), {2 * x - kLeg, 0.02, kApron},
            BoxTextures::all(wood_texture), small_things());
    add_box(model, on(place, {s * x, 0, size.z() - kBoard - kApron}), {0.02, 2 * y - kLeg, kApron},
            BoxTextures::all(wood_texture), small_things());
  }
}

void add_chair(RoomModel& model, const Place& place, WoodKind wood_kind, std::uint32_t seed) {
  constexpr double kSeat = 0.45;
  constexpr double kWidth = 0.43;
  const Texture texture = furniture_wood(wood_kind, seed);
  const BoxTextures faces = BoxTextures::all(texture);
  add_box(model, on(place, {0, 0, kSeat - 0.03}), {kWidth, kWidth, 0.03}, faces, furniture_faces(),
          true);
  for (const double x : {-0.18, 0.18}) {
    add_tube(model,
             {place.to_world({x, -0.19, 0}), place.to_world({0.94 * x, -0.17, kSeat - 0.03})},
             0.016, texture);
    add_tube(model,
             {place.to_world({x, 0.20, 0}), place.to_world({x, 0.19, kSeat}),
              place.to_world({x, 0.22, 0.70}), place.to_world({x, 0.26, 0.90})},
             0.016, texture);
  }
  for (const double z : {0.58, 0.72, 0.84}) {
    const double y = 0.205 + 0.06 * (z - 0.58) / 0.3;
    add_box(model, on(place, {0, y, z}), {0.36, 0.016, 0.065}, faces, small_things(), true);
  }
}

void add_cabinet(RoomModel& model, const Place& place, const Vector3d& size, WoodKind wood_kind,
                 int doors, std::uint32_t seed) {
  const Texture texture = furniture_wood(wood_kind, seed);
  BoxTextures faces = BoxTextures::all(texture);
  faces.front = door_front(texture, size.x(), size.z() - 0.1, doors);
  add_box(model, on(place, {0, 0.02, 0}), {size.x() - 0.08, size.y() - 0.06, 0.1},
          BoxTextures::all(plain(Color::Constant(0.03F))), small_things());
  add_box(model, on(place, {0, 0, 0.1}), {size.x(), size.y(), size.z() - 0.1}, faces,
          furniture_faces());
}

void add_bookshelf(RoomModel& model, const Place& place, const Vector3d& size, WoodKind wood_kind,
                   int shelves, std::uint64_t seed) {
  constexpr double kBoard = 0.022;
  Random random(seed);
  const Texture texture = furniture_wood(wood_kind, static_cast<std::uint32_t>(seed));
  const BoxTextures faces = BoxTextures::all(texture);
  const double x = 0.5 * (size.x() - kBoard);
  add_box(model, on(place, {-x, 0, 0}), {kBoard, size.y(), size.z()}, faces, furniture_faces());
  add_box(model, on(place, {x, 0, 0}), {kBoard, size.y(), size.z()}, faces, furniture_faces());
  const double inner = size.x() - 2 * kBoard;
  add_flat(model, place.to_world({-0.5 * inner, 0.5 * size.y() - 0.01, 0}),
           place.turn({inner, 0, 0}), {0, 0, size.z()}, texture, furniture_faces());
  const double step = (size.z() - kBoard) / shelves;
  for (int i = 0; i <= shelves; ++i) {
    add_box(model, on(place, {0, 0, i * step}), {inner, size.y() - 0.002, kBoard}, faces,
            furniture_faces(), true);
    if (i == shelves) break;
    const double z = i * step + kBoard;
    const double begin = -0.5 * inner + 0.01 + random.uniform(0.0, 0.06);
    const double fill = inner * random.uniform(0.55, 0.85);
    const double took = add_book_row(model, on(place, {begin, -0.02, z}), fill,
                                     step - kBoard - 0.03, size.y() - 0.08, random.next());
    const double left = begin + took + 0.13;
    if (left > 0.5 * inner - 0.08) continue;
    const Place thing = on(place, {left, 0, z}, random.uniform(-0.4, 0.4));
    if (i % 2 == 0) {
      add_vase(model, thing, color_from_srgb(i % 4 == 0 ? 0x3F6E7A : 0xC9714B), random.next());
    } else {
      add_book_stack(model, thing, 3, random.next());
    }
  }
}

void add_sofa(RoomModel& model, const Place& place, double width, const Color& color,
              std::uint32_t seed) {
  const Texture cloth = fabric(color, seed);
  add_box(model, on(place, {0, 0.02, 0.06}), {width - 0.1, 0.78, 0.22}, BoxTextures::all(cloth),
          small_things());
  const int seats = width > 1.2 ? 2 : 1;
  const double seat = (width - 0.36) / seats;
  for (int i = 0; i < seats; ++i) {
    const double x = (i - 0.5 * (seats - 1)) * seat;
    add_cushion(model, on(place, {x, -0.07, 0.26}), {seat * 1.01, 0.68, 0.19}, 0.30, cloth);
    add_cushion(model, on(place, {x, 0.25, 0.38}), {seat * 0.99, 0.24, 0.50}, 0.40, cloth);
  }
  for (const double s : {-1.0, 1.0}) {
    add_cushion(model, on(place, {s * 0.5 * (width - 0.18), 0.0, 0.04}), {0.20, 0.86, 0.58}, 0.30,
                cloth);
  }
  add_cushion(model, on(place, {0, 0.38, 0.04}), {width, 0.18, 0.78}, 0.30, cloth);
  const Texture accent = fabric(color_from_srgb(0xD9A441), seed + 5);
  add_cushion(model, on(place, {-0.28 * width, -0.02, 0.44}, 0.3), {0.42, 0.16, 0.36}, 0.62,
              accent);
}

}  // namespace planecast::engine::synth
