#include "engine/sequence/synth/furniture.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/sequence/synth/furniture_parts.h"
#include "engine/sequence/synth/random.h"

namespace planecast::engine::synth {

using Eigen::Vector3d;

namespace {

constexpr double kPi = std::numbers::pi;

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
