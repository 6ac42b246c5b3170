#include "test/bench/fitting/worlds.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "slam/geometry/random.h"

namespace planecast::bench {

namespace {

using slam::Random;

constexpr double kWidth = 640.0;
constexpr double kHeight = 480.0;
constexpr double kFocal = 525.0;

/// Box-Muller; one of the two numbers is left unused.
double gauss(Random& random) {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - random.uniform()));
  return radius * std::cos(2.0 * M_PI * random.uniform());
}

double between(Random& random, double low, double high) {
  return low + (high - low) * random.uniform();
}

/// What a mask holds, in the instance's own coordinates 0..1: the instance between `low` and `high`
/// of its first axis, and how many of the points come from the surface that adjoins at 1.
struct Content {
  double low = 0.0;
  double high = 1.0;
  double foreign = 0.0;        ///< share of the points
  double foreign_depth = 0.0;  ///< how far the mask reaches beyond the border
};

Content content_of(const Mask& mask) {
  switch (mask.kind) {
    case Corruption::kErosion:
      return {0.5 * mask.share, 1.0 - 0.5 * mask.share, 0.0, 0.0};
    case Corruption::kLeakage:
      return {0.0, 1.0, mask.share, mask.share / (1.0 - mask.share)};
    case Corruption::kMerged:
      return {0.0, 1.0, mask.share, 1.0};
    case Corruption::kSplit:
      return {0.0, 1.0 - mask.share, 0.0, 0.0};
    case Corruption::kNone:
      break;
  }
  return {};
}

/// Homography of the plane normal . x = distance between two cameras.
Eigen::Matrix3d homography_of(const Eigen::Vector3d& normal, double distance,
                              const Eigen::Matrix3d& rotation, const Eigen::Vector3d& step) {
  Eigen::Matrix3d camera;
  camera << kFocal, 0.0, 0.5 * kWidth, 0.0, kFocal, 0.5 * kHeight, 0.0, 0.0, 1.0;
  const Eigen::Matrix3d h =
      camera * (rotation + step * normal.transpose() / distance) * camera.inverse();
  return h / h(2, 2);
}

Eigen::Vector2d transfer(const Eigen::Matrix3d& h, const Eigen::Vector2d& x) {
  return (h * x.homogeneous()).hnormalized();
}

Eigen::Vector2d noise_2d(Random& random, double sigma) {
  const double x = gauss(random);
  return sigma * Eigen::Vector2d(x, gauss(random));
}

}  // namespace

std::string name_of(const Mask& mask) {
  const int percent = static_cast<int>(std::lround(100.0 * mask.share));
  switch (mask.kind) {
    case Corruption::kErosion:
      return fmt::format("erosion {} %", percent);
    case Corruption::kLeakage:
      return fmt::format("leakage {} %", percent);
    case Corruption::kMerged:
      return fmt::format("merged, {} % of another", percent);
    case Corruption::kSplit:
      return fmt::format("split, {} % lost", percent);
    case Corruption::kNone:
      break;
  }
  return "clean";
}

HomographyWorld make_homography_world(int points, double noise_px, double outliers,
                                      const Mask& mask, std::uint64_t seed) {
  Random random(seed);
  const Eigen::Vector3d tilt(between(random, -0.4, 0.4), between(random, -0.4, 0.4), 1.0);
  const Eigen::Vector3d axis(gauss(random), gauss(random), gauss(random));
  const Eigen::Matrix3d rotation =
      Eigen::AngleAxisd(between(random, 0.02, 0.12), axis.normalized()).toRotationMatrix();
  const Eigen::Vector3d step(between(random, 0.1, 0.3), between(random, -0.15, 0.15),
                             between(random, -0.1, 0.1));
  HomographyWorld world;
  world.cur_H_ref = homography_of(tilt.normalized(), 2.0, rotation, step);
  // The surface that adjoins falls away from the instance's right border.
  const Eigen::Vector3d other = Eigen::Vector3d(tilt.x() + 1.2, tilt.y(), tilt.z()).normalized();
  const Eigen::Matrix3d other_h = homography_of(other, 2.4, rotation, step);
  const Content content = content_of(mask);
  const Eigen::Vector2d low(80.0, 60.0);
  const Eigen::Vector2d size(300.0, 360.0);
  for (int i = 0; i < points; ++i) {
    const double kind = random.uniform();
    const bool foreign = kind < content.foreign;
    const bool gross = !foreign && random.uniform() < outliers;
    const double along = foreign ? between(random, 1.0, 1.0 + 0.8 * content.foreign_depth)
                                 : between(random, content.low, content.high);
    const Eigen::Vector2d ref = low + size.cwiseProduct(Eigen::Vector2d(along, random.uniform()));
    Eigen::Vector2d cur = transfer(foreign ? other_h : world.cur_H_ref, ref);
    if (gross) cur = {kWidth * random.uniform(), kHeight * random.uniform()};
    world.pairs.push_back({ref + noise_2d(random, noise_px), cur + noise_2d(random, noise_px)});
    world.inlier.push_back(foreign || gross ? 0 : 1);
    world.quality.push_back(
        static_cast<float>(gross ? between(random, 0.2, 1.0) : between(random, 0.0, 0.8)));
  }
  for (int y = 0; y <= 8; ++y) {
    for (int x = 0; x <= 8; ++x) {
      world.region.push_back(low + size.cwiseProduct(Eigen::Vector2d(x / 8.0, y / 8.0)));
    }
  }
  return world;
}

PlaneWorld make_plane_world(int points, double noise_m, double outliers, const Mask& mask,
                            std::uint64_t seed) {
  Random random(seed);
  const Eigen::Vector3d axis(gauss(random), gauss(random), gauss(random));
  const Eigen::AngleAxisd turn(between(random, 0.0, 0.8), axis.normalized());
  const Eigen::Vector3d centre(0.0, 0.0, 2.0);
  const Content content = content_of(mask);
  PlaneWorld world;
  const auto to_world = [&](double along, double across, double above) {
    return Eigen::Vector3d(centre + turn * Eigen::Vector3d(along - 0.5, across - 0.5, -above));
  };
  world.plane.normal = turn * -Eigen::Vector3d::UnitZ();
  world.centroid = to_world(0.5 * (content.low + content.high), 0.5, 0.0);
  world.plane.offset = -world.plane.normal.dot(centre);
  for (int i = 0; i < points; ++i) {
    const double across = random.uniform();
    const bool foreign = random.uniform() < content.foreign;
    const bool gross = !foreign && random.uniform() < outliers;
    Eigen::Vector3d point = to_world(between(random, content.low, content.high), across, 0.0);
    if (foreign && mask.kind == Corruption::kMerged) {
      point = to_world(between(random, 1.0, 2.0), across, 0.08);
    } else if (foreign) {
      // Upright on the border: its foot lies within the band.
      point = to_world(1.0, across, between(random, 0.0, content.foreign_depth));
    }
    if (gross) point += world.plane.normal * between(random, -0.3, 0.3);
    for (int k = 0; k < 3; ++k) point[k] += noise_m * gauss(random);
    world.points.positions.push_back(point);
    world.points.view_from.push_back(-point.normalized());
    world.points.band.push_back(1.0);
    world.inlier.push_back(foreign || gross ? 0 : 1);
  }
  return world;
}

}  // namespace planecast::bench
