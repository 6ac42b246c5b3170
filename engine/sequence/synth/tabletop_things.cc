#include "engine/sequence/synth/furniture.h"

#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>

#include "engine/sequence/synth/furniture_parts.h"
#include "engine/sequence/synth/random.h"

namespace planecast::engine::synth {

using Eigen::Vector3d;

namespace {

constexpr double kPi = std::numbers::pi;

}  // namespace

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

}  // namespace planecast::engine::synth
