#include "engine/sequence/synth/furniture.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "engine/sequence/synth/random.h"

namespace planecast::engine::synth {

namespace {

using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;

/// Small things: never labelled, painted finely.
FlatOptions small_things() { return {"none", 800.0F, 0.02F}; }
FlatOptions furniture_faces() { return {"", 500.0F, 0.035F}; }

Place on(const Place& place, const Vector3d& local, double turn = 0.0) {
  return {place.to_world(local), place.yaw + turn};
}

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

void add_leaf(RoomModel& model, const Vector3d& root, double azimuth, double rise, double length,
              double width, const Texture& texture) {
  constexpr int kRows = 6;
  const Vector3d out(std::cos(azimuth), std::sin(azimuth), 0.0);
  const Vector3d side(-out.y(), out.x(), 0.0);
  std::vector<Vector3d> points;
  for (int j = 0; j <= kRows; ++j) {
    const double t = static_cast<double>(j) / kRows;
    const Vector3d spine = root + length * (t * std::cos(rise) * (0.7 + 0.3 * t)) * out +
                           length * (t * std::sin(rise) * (1.35 - 0.75 * t)) * Vector3d::UnitZ();
    const double half = 0.5 * width * std::sin(kPi * std::pow(0.04 + 0.95 * t, 0.8));
    points.push_back(spine - half * side + 0.25 * half * Vector3d::UnitZ());
    points.push_back(spine);
    points.push_back(spine + half * side + 0.25 * half * Vector3d::UnitZ());
  }
  add_sheet(model, 2, kRows, points, texture, static_cast<float>(width), static_cast<float>(length),
            500.0F);
}

Texture leaf_texture(double width, std::uint32_t seed) {
  static constexpr std::uint32_t kGreens[] = {0x3F6B3A, 0x55803F, 0x2F5A3B};
  const Color base = color_from_srgb(kGreens[seed % 3]);
  const Texture flesh = mottled(base, 1.5F * base, 0.03F, seed);
  const auto middle = static_cast<float>(0.5 * width);
  return [=](float u, float v) -> Color {
    const float rib = std::abs(u - middle);
    const float vein = std::abs(std::sin(90.0F * (v - 0.8F * rib)));
    return flesh(u, v) * (rib < 0.06F * middle ? 1.7F : 0.88F + 0.24F * vein);
  };
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

void add_book_stack(RoomModel& model, const Place& place, int books, std::uint64_t seed) {
  Random random(seed);
  double z = 0.0;
  double shrink = 1.0;
  for (int i = 0; i < books; ++i) {
    const double width = shrink * random.uniform(0.20, 0.235);
    const double depth = 0.72 * width;
    const double thick = random.uniform(0.016, 0.036);
    const std::uint64_t own = random.next();
    const Texture pages = mottled(color_from_srgb(0xEFE6D2), color_from_srgb(0xD8CDB4), 0.004F,
                                  static_cast<std::uint32_t>(own));
    BoxTextures faces = BoxTextures::all(pages);
    faces.top = picture(draw_print(PrintKind::kCover, 300, 216, own), static_cast<float>(width),
                        static_cast<float>(depth));
    cv::Mat spine = draw_spine(72, 480, own);
    cv::rotate(spine, spine, cv::ROTATE_90_COUNTERCLOCKWISE);
    faces.front = picture(spine, static_cast<float>(width), static_cast<float>(thick));
    add_box(model,
            on(place, {random.uniform(-0.012, 0.012), random.uniform(-0.01, 0.01), z},
               random.uniform(-0.22, 0.22)),
            {width, depth, thick}, faces, small_things());
    z += thick + 0.0005;
    shrink *= 0.95;
  }
}

double add_book_row(RoomModel& model, const Place& place, double width, double height, double depth,
                    std::uint64_t seed) {
  Random random(seed);
  double x = 0.0;
  const Texture pages = plain(color_from_srgb(0xE6DCC6));
  for (int i = 0; i < 60; ++i) {
    const double thick = random.uniform(0.016, 0.042);
    if (x + thick > width) break;
    const double tall = height * random.uniform(0.66, 0.97);
    const std::uint64_t own = random.next();
    const cv::Mat spine = draw_spine(60, 420, own);
    BoxTextures faces = BoxTextures::all(plain(picture(spine, 1.0F, 1.0F)(0.5F, 0.03F)));
    faces.front = picture(spine, static_cast<float>(thick), static_cast<float>(tall));
    faces.top = pages;
    add_box(model, on(place, {x + 0.5 * thick, random.uniform(-0.012, 0.012), 0}),
            {thick - 0.001, depth, tall}, faces, small_things());
    x += thick;
  }
  return x;
}

void add_mug(RoomModel& model, const Place& place, const Color& color, std::uint32_t seed) {
  const Texture glaze = mottled(color, 1.12F * color, 0.02F, seed);
  const Texture band = [glaze](float u, float v) -> Color {
    return v > 0.03F && v < 0.052F ? Color(0.75F, 0.70F, 0.60F) : glaze(u, v);
  };
  add_revolution(model, place,
                 {{0.0, 0.001},
                  {0.034, 0.001},
                  {0.038, 0.006},
                  {0.040, 0.05},
                  {0.041, 0.094},
                  {0.0395, 0.096},
                  {0.0375, 0.093},
                  {0.0365, 0.074}},
                 band);
  // Coffee, as a flat disc of a surface of revolution.
  add_revolution(model, place, {{0.0365, 0.074}, {0.0, 0.074}}, plain(Color(0.03F, 0.015F, 0.008F)),
                 20);
  std::vector<Vector3d> handle;
  for (int i = 0; i <= 10; ++i) {
    const double angle = kPi * (0.5 - static_cast<double>(i) / 10);
    handle.push_back(
        place.to_world({0.037 + 0.026 * std::cos(angle), 0, 0.05 + 0.028 * std::sin(angle)}));
  }
  add_tube(model, handle, 0.006, glaze, 8);
}

void add_fruit_bowl(RoomModel& model, const Place& place, std::uint64_t seed) {
  Random random(seed);
  const auto texture_seed = static_cast<std::uint32_t>(seed);
  const Texture clay =
      mottled(color_from_srgb(0xE7E2D6), color_from_srgb(0xC9D3D2), 0.04F, texture_seed);
  add_revolution(model, place,
                 {{0.0, 0.001},
                  {0.05, 0.001},
                  {0.052, 0.012},
                  {0.09, 0.035},
                  {0.125, 0.075},
                  {0.122, 0.078},
                  {0.085, 0.040},
                  {0.045, 0.020},
                  {0.0, 0.018}},
                 clay, 32);
  static constexpr std::uint32_t kFruit[][2] = {
      {0xE8892B, 0xF0A03C}, {0xB53A2C, 0xD9A23E}, {0x8FA83A, 0xC9C24F}, {0xE8892B, 0xEB9A37}};
  for (int i = 0; i < 5; ++i) {
    const double angle = 2.0 * kPi * i / 4.0 + 0.4;
    const double radius = i < 4 ? 0.052 : 0.0;
    const double size = random.uniform(0.034, 0.040);
    const auto& pair = kFruit[i % 4];
    add_ball(
        model,
        place.to_world({radius * std::cos(angle), radius * std::sin(angle), i < 4 ? 0.066 : 0.112}),
        size,
        mottled(color_from_srgb(pair[0]), color_from_srgb(pair[1]), 0.03F,
                texture_seed + static_cast<std::uint32_t>(i)));
  }
}

void add_vase(RoomModel& model, const Place& place, const Color& color, std::uint64_t seed) {
  Random random(seed);
  const Texture glaze =
      mottled(0.85F * color, 1.2F * color, 0.05F, static_cast<std::uint32_t>(seed));
  add_revolution(model, place,
                 {{0.0, 0.001},
                  {0.035, 0.001},
                  {0.055, 0.03},
                  {0.062, 0.07},
                  {0.050, 0.115},
                  {0.027, 0.145},
                  {0.024, 0.165},
                  {0.031, 0.18},
                  {0.028, 0.18},
                  {0.020, 0.16}},
                 glaze);
  const Texture twig = plain(color_from_srgb(0x6B5138));
  for (int i = 0; i < 5; ++i) {
    const double angle = random.uniform(0, 2 * kPi);
    const double lean = random.uniform(0.02, 0.07);
    const Vector3d out(std::cos(angle), std::sin(angle), 0);
    std::vector<Vector3d> path;
    for (int k = 0; k <= 4; ++k) {
      const double t = k / 4.0;
      path.push_back(place.to_world(lean * t * t * out + Vector3d(0, 0, 0.15 + 0.19 * t)));
    }
    add_tube(model, path, 0.0018, twig, 6);
    for (int k = 1; k <= 4; ++k) {
      add_ball(model, path[static_cast<std::size_t>(k)], 0.008,
               plain(color_from_srgb(i % 2 == 0 ? 0xEFE3D0 : 0xD98A78)));
    }
  }
}

void add_plant(RoomModel& model, const Place& place, double pot_m, int leaves, double leaf_m,
               std::uint64_t seed) {
  Random random(seed);
  const auto texture_seed = static_cast<std::uint32_t>(seed);
  const double r = 0.5 * pot_m;
  const double h = 0.95 * pot_m;
  add_revolution(model, place,
                 {{0.0, 0.001},
                  {0.68 * r, 0.001},
                  {0.90 * r, 0.78 * h},
                  {0.91 * r, 0.8 * h},
                  {r, 0.8 * h},
                  {r, h},
                  {0.90 * r, h},
                  {0.86 * r, 0.88 * h}},
                 mottled(color_from_srgb(0xC67A52), color_from_srgb(0xB0623F), 0.05F, texture_seed),
                 32);
  add_revolution(
      model, place, {{0.86 * r, 0.88 * h}, {0.0, 0.90 * h}},
      mottled(color_from_srgb(0x3A2C22), color_from_srgb(0x241A14), 0.012F, texture_seed), 24);
  for (int i = 0; i < leaves; ++i) {
    const double t = static_cast<double>(i) / leaves;
    const double azimuth = place.yaw + 2.399963 * i + random.uniform(-0.2, 0.2);  // golden angle
    const double rise = 0.35 + 1.0 * t + random.uniform(-0.08, 0.08);
    const double length = leaf_m * random.uniform(0.8, 1.1);
    const double width = 0.42 * length;
    const Vector3d root = place.to_world({0, 0, 0.9 * h});
    const Vector3d out(std::cos(azimuth), std::sin(azimuth), 0);
    const double stem = leaf_m * random.uniform(0.35, 0.6);
    const Vector3d tip =
        root + stem * (std::cos(rise) * 0.5 * out + std::sin(rise) * Vector3d::UnitZ());
    add_tube(model, {root, 0.5 * (root + tip) + 0.03 * stem * Vector3d::UnitZ(), tip},
             0.010 * leaf_m + 0.0012, plain(color_from_srgb(0x5E7F45)), 6);
    add_leaf(model, tip, azimuth, rise - 0.25, length, width,
             leaf_texture(width, texture_seed + static_cast<std::uint32_t>(i)));
  }
}

void add_lamp(RoomModel& model, const Place& place, double height, double shade_m,
              std::uint32_t seed) {
  const double shade_height = 0.72 * shade_m;
  const double low = height - shade_height;
  const Texture metal = mottled(color_from_srgb(0x8C744A), color_from_srgb(0xB79A66), 0.05F, seed);
  const double foot = 0.30 * shade_m;
  add_revolution(model, place,
                 {{0.0, 0.001},
                  {foot, 0.001},
                  {foot, 0.012},
                  {0.35 * foot, 0.022},
                  {0.012, 0.04},
                  {0.012, low + 0.5 * shade_height}},
                 metal, 24);
  const Texture weave = fabric(Color::Ones(), seed);
  const auto top = static_cast<float>(shade_height);
  const Texture glow = [weave, top](float u, float v) -> Color {
    const float t = v / top - 0.45F;
    return weave(u, v).cwiseProduct(Color(0.98F, 0.74F, 0.44F)) * (0.92F - 1.1F * t * t);
  };
  add_revolution(model, place, {{0.5 * shade_m, low}, {0.36 * shade_m, height}}, glow, 36, true);
  add_revolution(model, place, {{0.36 * shade_m, height - 0.002}, {0.49 * shade_m, low + 0.002}},
                 glow, 36, true);
  LampLight lamp;
  lamp.position = place.to_world({0, 0, low + 0.45 * shade_height}).cast<float>();
  lamp.radius_m = static_cast<float>(0.25 * shade_m);
  lamp.intensity = Color(1.0F, 0.70F, 0.40F) * static_cast<float>(1.6 * shade_m);
  model.lamps.push_back(lamp);
}

void add_pencil(RoomModel& model, const Vector3d& from, const Vector3d& to, const Color& color) {
  const Vector3d neck = from + 0.88 * (to - from);
  add_tube(model, {from, neck}, 0.0036, plain(color), 6);
  add_tube(model, {neck, 0.5 * (neck + to)}, 0.0026, plain(color_from_srgb(0xE6C79A)), 6);
  add_tube(model, {0.5 * (neck + to), to}, 0.0012, plain(Color::Constant(0.03F)), 6);
}

void add_toy_block(RoomModel& model, const Place& place, double size, std::uint64_t seed) {
  Random random(seed);
  BoxTextures faces;
  for (Texture* face : {&faces.front, &faces.right, &faces.back, &faces.left, &faces.top}) {
    const PrintKind kind = random.below(2) == 0 ? PrintKind::kShapes : PrintKind::kBlocks;
    *face = picture(draw_print(kind, 160, 160, random.next()), static_cast<float>(size),
                    static_cast<float>(size));
  }
  add_box(model, place, Vector3d::Constant(size), faces, small_things());
}

void add_curtain(RoomModel& model, const Vector3d& from, const Vector3d& to, double drop,
                 const Color& color, std::uint32_t seed) {
  const double length = (to - from).norm();
  const Vector3d along = (to - from) / length;
  const Vector3d out = along.cross(Vector3d::UnitZ());
  const int cols = std::max(24, static_cast<int>(length * 90));
  constexpr int kRows = 6;
  std::vector<Vector3d> points;
  for (int j = 0; j <= kRows; ++j) {
    const double t = static_cast<double>(j) / kRows;  // from the hem up
    for (int i = 0; i <= cols; ++i) {
      const double s = length * i / cols;
      const double fold =
          (0.032 - 0.012 * t) * std::sin(2.0 * kPi * s / 0.115 + 0.5 * std::sin(5.0 * s + t)) +
          0.010 * std::sin(31.0 * s);
      points.push_back(from + s * along + fold * out - (1.0 - t) * drop * Vector3d::UnitZ());
    }
  }
  add_sheet(model, cols, kRows, points, fabric(color, seed), static_cast<float>(1.6 * length),
            static_cast<float>(drop), 260.0F);
}

}  // namespace planecast::engine::synth
