#include "engine/sequence/synth/training_clutter.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/sequence/synth/furniture.h"
#include "engine/sequence/synth/noise.h"

namespace planecast::engine::synth {
namespace {

using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;

Texture unpainted() { return plain(Color::Ones()); }

/// A rod with round ends, `from_radius` to `to_radius` thick.
void add_capsule(TrainingBuilder& builder, const Vector3d& from, const Vector3d& to,
                 double from_radius, double to_radius) {
  constexpr int kCols = 12;
  constexpr int kRows = 9;
  const Vector3d along = (to - from).normalized();
  const Vector3d side = along.unitOrthogonal();
  const Vector3d other = along.cross(side);
  std::vector<Vector3d> points;
  for (int j = 0; j <= kRows; ++j) {
    // A quarter of the rows rounds each end.
    const double t = static_cast<double>(j) / kRows;
    const double end = t < 0.3 ? 1.0 - t / 0.3 : t > 0.7 ? (t - 0.7) / 0.3 : 0.0;
    const bool first = t < 0.5;
    const double radius = first ? from_radius : to_radius;
    const double angle = 0.5 * kPi * end;
    const Vector3d middle =
        (first ? from : to) + (first ? -1.0 : 1.0) * radius * std::sin(angle) * along;
    for (int i = 0; i <= kCols; ++i) {
      const double around = 2.0 * kPi * i / kCols;
      points.push_back(middle + radius * std::cos(angle) *
                                    (std::cos(around) * side + std::sin(around) * other));
    }
  }
  add_sheet(builder.model(), kCols, kRows, points, unpainted(),
            static_cast<float>(2.0 * kPi * from_radius), static_cast<float>((to - from).norm()));
}

}  // namespace

void add_lump(TrainingBuilder& builder, const Place& place, const Vector3d& size) {
  constexpr int kCols = 20;
  constexpr int kRows = 10;
  Random& random = builder.random();
  const double squareness = random.uniform(0.45, 1.1);
  const double rough = random.uniform(0.0, 0.35);
  const auto frequency = static_cast<float>(random.uniform(1.0, 4.0));
  const auto seed = static_cast<std::uint32_t>(random.next());
  const auto power = [squareness](double x) {
    return std::copysign(std::pow(std::abs(x), squareness), x);
  };
  std::vector<Vector3d> points;
  for (int j = 0; j <= kRows; ++j) {
    const double polar = kPi * (static_cast<double>(j) / kRows - 0.5);
    for (int i = 0; i <= kCols; ++i) {
      const double around = 2.0 * kPi * (i % kCols) / kCols;
      const Vector3d out(power(std::cos(polar)) * power(std::cos(around)),
                         power(std::cos(polar)) * power(std::sin(around)), power(std::sin(polar)));
      const auto bump = static_cast<double>(
          fractal_noise(frequency * static_cast<float>(out.x() + 0.5 * out.z()),
                        frequency * static_cast<float>(out.y() - 0.5 * out.z()), 3, seed));
      const Vector3d local = 0.5 * (1.0 + rough * bump) * out.cwiseProduct(size);
      points.push_back(place.to_world(local + Vector3d(0, 0, 0.45 * size.z())));
    }
  }
  add_sheet(builder.model(), kCols, kRows, points, unpainted(),
            static_cast<float>(size.x() + size.y()), static_cast<float>(size.z() + size.x()));
  builder.paint(builder.chance(0.5) ? TileKind::kCloth : TileKind::kObject);
}

void add_crumpled_cloth(TrainingBuilder& builder, const Place& place, const Eigen::Vector2d& size,
                        double height) {
  constexpr int kCells = 20;
  Random& random = builder.random();
  const auto frequency = static_cast<float>(random.uniform(2.0, 6.0));
  const auto seed = static_cast<std::uint32_t>(random.next());
  std::vector<Vector3d> points;
  for (int j = 0; j <= kCells; ++j) {
    for (int i = 0; i <= kCells; ++i) {
      const double s = static_cast<double>(i) / kCells - 0.5;
      const double t = static_cast<double>(j) / kCells - 0.5;
      const float x = frequency * static_cast<float>(s);
      const float y = frequency * static_cast<float>(t);
      // Ridges, as folds are: the fold of a smooth function.
      const auto fold = static_cast<double>(1.0F - std::abs(fractal_noise(x, y, 3, seed)) * 1.6F);
      const auto wander = static_cast<double>(smooth_noise(x, y, seed + 7));
      const double edge = std::clamp(8.0 * (0.5 - std::max(std::abs(s), std::abs(t))), 0.0, 1.0);
      const Vector3d local((s + 0.08 * wander) * size.x(), (t - 0.08 * wander) * size.y(),
                           0.004 + height * std::max(fold, 0.0) * (0.3 + 0.7 * edge));
      points.push_back(place.to_world(local));
    }
  }
  add_sheet(builder.model(), kCells, kCells, points, unpainted(), static_cast<float>(size.x()),
            static_cast<float>(size.y()));
  builder.paint(TileKind::kCloth);
}

void add_turned_thing(TrainingBuilder& builder, const Place& place, double radius, double height) {
  Random& random = builder.random();
  const int rows = 3 + random.below(6);
  std::vector<ProfilePoint> profile = {{0.0, 0.001}};
  const bool straight = builder.chance(0.35);
  double r = radius;
  for (int i = 0; i <= rows; ++i) {
    if (!straight) r = radius * random.uniform(0.3, 1.0);
    profile.push_back({r, height * i / rows});
  }
  profile.push_back({0.0, height * 1.02});
  add_revolution(builder.model(), place, profile, unpainted(), 18);
  TrainingMaterial& material = builder.paint(TileKind::kObject);
  if (builder.chance(0.1)) material.paint.glow = static_cast<float>(random.uniform(0.5, 2.0));
}

void add_folded_curtain(TrainingBuilder& builder, const Vector3d& from, const Vector3d& to,
                        double drop) {
  constexpr int kCols = 60;
  constexpr int kRows = 4;
  Random& random = builder.random();
  const double folds = (to - from).norm() * random.uniform(4.0, 10.0);
  const double depth = random.uniform(0.03, 0.08);
  const Vector3d out = (to - from).cross(Vector3d::UnitZ()).normalized();
  const auto seed = static_cast<std::uint32_t>(random.next());
  std::vector<Vector3d> points;
  for (int j = 0; j <= kRows; ++j) {
    for (int i = 0; i <= kCols; ++i) {
      const double t = static_cast<double>(i) / kCols;
      const auto wander = static_cast<double>(smooth_noise(
          static_cast<float>(3.0 * folds * t / 5.0), 0.4F * static_cast<float>(j), seed));
      const double wave = depth * std::sin(2.0 * kPi * folds * t + 1.5 * wander);
      points.push_back(from + t * (to - from) + (wave + depth) * out -
                       Vector3d(0, 0, drop * (kRows - j) / kRows));
    }
  }
  add_sheet(builder.model(), kCols, kRows, points, unpainted(),
            static_cast<float>(1.5 * (to - from).norm()), static_cast<float>(drop));
  builder.paint(TileKind::kCloth);
}

void add_cables(TrainingBuilder& builder, const Place& place, double reach) {
  Random& random = builder.random();
  const int cables = 1 + random.below(4);
  const double radius = random.uniform(0.003, 0.012);
  for (int c = 0; c < cables; ++c) {
    std::vector<Vector3d> path;
    Vector3d at(random.uniform(-reach, reach), random.uniform(-reach, reach), radius);
    double heading = random.uniform(0.0, 2.0 * kPi);
    for (int i = 0; i < 12; ++i) {
      path.push_back(place.to_world(at));
      heading += random.uniform(-0.9, 0.9);
      at += 0.22 * reach * Vector3d(std::cos(heading), std::sin(heading), 0);
      at.z() = radius * random.uniform(1.0, 6.0);
    }
    add_tube(builder.model(), path, radius, unpainted(), 6);
  }
  builder.paint(TileKind::kObject);
}

void add_person(TrainingBuilder& builder, const Place& place) {
  Random& random = builder.random();
  const bool sits = builder.chance(0.5);
  const double hip = sits ? random.uniform(0.45, 0.55) : random.uniform(0.8, 1.0);
  const double lean = random.uniform(-0.25, 0.3);
  const double wide = random.uniform(0.13, 0.19);
  const Vector3d pelvis(0, 0, hip);
  const Vector3d neck(0, -lean * 0.5, hip + random.uniform(0.48, 0.6));
  const auto world = [&place](const Vector3d& local) { return place.to_world(local); };
  for (const double s : {-1.0, 1.0}) {
    const Vector3d root(s * 0.1, 0, hip);
    const Vector3d knee = sits ? Vector3d(s * 0.14, -0.42, hip + 0.02)
                               : Vector3d(s * 0.12, random.uniform(-0.2, 0.05), 0.5 * hip);
    const Vector3d foot(knee.x(), knee.y() + random.uniform(-0.1, 0.15), 0.05);
    add_capsule(builder, world(root), world(knee), 0.09, 0.065);
    add_capsule(builder, world(knee), world(foot), 0.065, 0.05);
  }
  builder.paint(TileKind::kCloth);
  add_capsule(builder, world(pelvis), world(neck - Vector3d(0, 0, 0.12)), wide, 1.15 * wide);
  for (const double s : {-1.0, 1.0}) {
    const Vector3d shoulder = neck + Vector3d(s * (wide + 0.05), 0, -0.1);
    const Vector3d elbow =
        shoulder + Vector3d(s * 0.08, random.uniform(-0.22, 0.1), random.uniform(-0.3, -0.1));
    add_capsule(builder, world(shoulder), world(elbow), 0.06, 0.045);
    const Vector3d hand =
        elbow + Vector3d(s * random.uniform(-0.2, 0.1), -0.22, random.uniform(-0.2, 0.25));
    add_capsule(builder, world(elbow), world(hand), 0.045, 0.04);
  }
  builder.paint(TileKind::kCloth);
  const Vector3d head = neck + Vector3d(0, -0.03, 0.16);
  add_capsule(builder, world(head - Vector3d(0, 0, 0.06)), world(head + Vector3d(0, 0, 0.05)),
              0.095, 0.1);
  builder.paint(TileKind::kObject);
}

void add_bush(TrainingBuilder& builder, const Place& place, double size) {
  const int leaves = 8 + builder.random().below(18);
  const double pot = size * builder.random().uniform(0.2, 0.6);
  add_plant(builder.model(), place, pot, leaves, 0.55 * size, builder.random().next());
  builder.paint(TileKind::kObject);
}

void add_small_clutter(TrainingBuilder& builder, const Place& place, double size) {
  Random& random = builder.random();
  switch (random.below(6)) {
    case 0:
      return add_lump(builder, place,
                      {size, size * random.uniform(0.5, 1.3), size * random.uniform(0.3, 1.0)});
    case 1:
      return add_crumpled_cloth(builder, place, {1.6 * size, 1.6 * size * random.uniform(0.6, 1.2)},
                                size * random.uniform(0.15, 0.5));
    case 2:
      return add_bush(builder, place, 1.3 * size);
    case 3:
      add_ball(builder.model(), place.to_world({0, 0, 0.5 * size}), 0.5 * size, unpainted());
      builder.paint(TileKind::kObject);
      return;
    case 4:
      if (builder.chance(0.3)) return add_cables(builder, place, size);
      [[fallthrough]];
    default:
      return add_turned_thing(builder, place, size * random.uniform(0.15, 0.5),
                              size * random.uniform(0.6, 2.0));
  }
}

}  // namespace planecast::engine::synth
