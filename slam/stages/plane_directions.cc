#include "slam/stages/plane_directions.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace planecast::slam {

namespace {

/// Normals are known to about 5 degrees where a plane is far and to one where it is near.
constexpr double kAlike = 0.94;     ///< cosine within which points speak for one direction
constexpr double kInGroup = 0.9;    ///< ... within which they, and the planes, belong to it
constexpr std::size_t kSeeds = 60;  ///< points tried as the direction of most
constexpr std::size_t kMostGroups = 8;

/// The direction that most points of the pool face.
Eigen::Vector3d main_direction(const KeyframePoints& shown, const std::vector<int>& pool) {
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  int most = 0;
  const std::size_t step = (pool.size() + kSeeds - 1) / kSeeds;
  for (std::size_t seed = 0; seed < pool.size(); seed += step) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int alike = 0;
    for (const int i : pool) {
      if (shown.normal[i].dot(shown.normal[pool[seed]]) < kAlike) continue;
      sum += shown.normal[i];
      ++alike;
    }
    if (alike <= most) continue;
    most = alike;
    direction = sum.normalized();
  }
  return direction;
}

}  // namespace

std::vector<DirectionGroup> groups_by_direction(const KeyframePoints& shown, std::vector<int> pool,
                                                int min_size) {
  std::vector<DirectionGroup> groups;
  std::erase_if(pool, [&](int i) { return shown.normal[i].isZero(); });
  while (groups.size() < kMostGroups && static_cast<int>(pool.size()) >= min_size) {
    const Eigen::Vector3d direction = main_direction(shown, pool);
    const auto rest = std::stable_partition(
        pool.begin(), pool.end(), [&](int i) { return shown.normal[i].dot(direction) > kInGroup; });
    if (rest - pool.begin() < min_size) break;
    groups.push_back({{pool.begin(), rest}, direction});
    pool.erase(pool.begin(), rest);
  }
  return groups;
}

bool FacingPlaneModel::faces(const Parameters& model) const {
  return direction_.isZero() || model.normal.dot(direction_) > kInGroup;
}

}  // namespace planecast::slam
