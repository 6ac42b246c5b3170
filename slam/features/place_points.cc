#include "slam/features/place_points.h"

#include <cstddef>

namespace planecast::slam {
namespace {

int free_keypoint_at(const FoundPoint& point, double radius_px, const std::vector<char>& taken,
                     const Features& features, std::vector<int>& near) {
  near.clear();
  features.find_in_area(point.pixel, radius_px, point.octave - 1, point.octave + 1, near);
  int best = kNone;
  auto least = static_cast<float>(radius_px * radius_px);
  for (const int k : near) {
    if (taken[static_cast<std::size_t>(k)] != 0) continue;
    const float distance =
        (features.keypoints[static_cast<std::size_t>(k)].raw - point.raw).squaredNorm();
    if (distance < least) {
      least = distance;
      best = k;
    }
  }
  return best;
}

}  // namespace

std::vector<int> place_points(const std::vector<FoundPoint>& points, const Camera& camera,
                              double snap_px, const ScaleLevels& levels, OrbExtractor& extractor,
                              std::vector<char>& taken, Features& features) {
  std::vector<int> placed(points.size(), kNone);
  std::vector<Keypoint> missing;
  std::vector<std::size_t> missing_points;
  std::vector<int> near;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const FoundPoint& point = points[i];
    const int k =
        free_keypoint_at(point, snap_px * levels.scale(point.octave), taken, features, near);
    if (k == kNone) {
      Keypoint keypoint;
      keypoint.raw = point.raw;
      keypoint.pixel = point.pixel.cast<float>();
      keypoint.octave = point.octave;
      missing.push_back(keypoint);
      missing_points.push_back(i);
      continue;
    }
    placed[i] = k;
    taken[static_cast<std::size_t>(k)] = 1;
    // The grid still holds the old place: the keypoint is taken and not looked for again.
    features.keypoints[static_cast<std::size_t>(k)].raw = point.raw;
    features.keypoints[static_cast<std::size_t>(k)].pixel = point.pixel.cast<float>();
  }
  const std::vector<int> added = extractor.append(missing, features);
  for (std::size_t m = 0; m < added.size(); ++m) placed[missing_points[m]] = added[m];
  taken.resize(features.keypoints.size(), 1);
  features.build_grid(camera.width, camera.height);
  return placed;
}

}  // namespace planecast::slam
