#include "slam/features/matching.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace planecast::slam {
namespace {

constexpr int kRotationBins = 30;

int rotation_bin(float from_deg, float to_deg) {
  float turn = from_deg - to_deg;
  if (turn < 0.0F) turn += 360.0F;
  return static_cast<int>(turn * kRotationBins / 360.0F) % kRotationBins;
}

/// Which bins to keep: the fullest three, of which the second and third need a tenth of the first.
std::array<bool, kRotationBins> dominant_bins(const std::array<int, kRotationBins>& count) {
  std::array<int, kRotationBins> order{};
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return count[static_cast<std::size_t>(a)] > count[static_cast<std::size_t>(b)];
  });
  std::array<bool, kRotationBins> keep{};
  const int most = count[static_cast<std::size_t>(order[0])];
  for (std::size_t i = 0; i < 3; ++i) {
    const auto bin = static_cast<std::size_t>(order[i]);
    keep[bin] = count[bin] * 10 >= most;
  }
  return keep;
}

/// Drops pairs whose change of angle is not among the dominant ones.
template <typename AngleChange>
void keep_dominant_rotation(std::vector<std::pair<int, int>>& pairs, const AngleChange& bin_of) {
  std::array<int, kRotationBins> count{};
  for (const auto& pair : pairs) ++count[static_cast<std::size_t>(bin_of(pair))];
  const std::array<bool, kRotationBins> keep = dominant_bins(count);
  std::erase_if(pairs,
                [&](const auto& pair) { return !keep[static_cast<std::size_t>(bin_of(pair))]; });
}

/// Best and second best of a search.
struct Best {
  int index = -1;
  int distance = 257;
  int second_distance = 257;
  int octave = -1;
  int second_octave = -1;

  void offer(int candidate, int candidate_distance, int candidate_octave) {
    if (candidate_distance < distance) {
      second_distance = distance;
      second_octave = octave;
      distance = candidate_distance;
      octave = candidate_octave;
      index = candidate;
    } else if (candidate_distance < second_distance) {
      second_distance = candidate_distance;
      second_octave = candidate_octave;
    }
  }
};

/// One-to-one table: for each target the source that claims it with the least distance.
class Claims {
 public:
  explicit Claims(int targets)
      : source_(static_cast<std::size_t>(targets), -1),
        distance_(static_cast<std::size_t>(targets), 257) {}

  void claim(int source, int target, int distance) {
    const auto t = static_cast<std::size_t>(target);
    if (distance >= distance_[t]) return;
    source_[t] = source;
    distance_[t] = distance;
  }
  /// Pairs (target, source), ascending by target.
  std::vector<std::pair<int, int>> pairs() const {
    std::vector<std::pair<int, int>> result;
    for (std::size_t t = 0; t < source_.size(); ++t) {
      if (source_[t] >= 0) result.emplace_back(static_cast<int>(t), source_[t]);
    }
    return result;
  }

 private:
  std::vector<int> source_;
  std::vector<int> distance_;
};

std::vector<std::pair<int, int>> swapped_and_sorted(std::vector<std::pair<int, int>> pairs) {
  for (auto& pair : pairs) std::swap(pair.first, pair.second);
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace

std::vector<std::pair<int, int>> match_expectations(const Features& features,
                                                    const std::vector<Expectation>& expectations,
                                                    const std::vector<LandmarkId>& taken,
                                                    const ExpectationMatchOptions& options) {
  Claims claims(features.size());
  std::vector<int> candidates;
  for (std::size_t e = 0; e < expectations.size(); ++e) {
    const Expectation& expected = expectations[e];
    candidates.clear();
    features.find_in_area(expected.pixel, expected.radius_px, expected.min_octave,
                          expected.max_octave, candidates);
    Best best;
    for (const int candidate : candidates) {
      const auto c = static_cast<std::size_t>(candidate);
      if (!taken.empty() && taken[c] != kNone) continue;
      best.offer(candidate, hamming_distance(expected.descriptor, features.descriptors[c]),
                 features.keypoints[c].octave);
    }
    if (best.index < 0 || best.distance > options.max_distance) continue;
    if (best.octave == best.second_octave && best.distance > options.ratio * best.second_distance) {
      continue;
    }
    claims.claim(static_cast<int>(e), best.index, best.distance);
  }
  std::vector<std::pair<int, int>> pairs = claims.pairs();
  if (options.check_rotation) {
    keep_dominant_rotation(pairs, [&](const auto& pair) {
      return rotation_bin(expectations[static_cast<std::size_t>(pair.second)].angle_deg,
                          features.keypoints[static_cast<std::size_t>(pair.first)].angle_deg);
    });
  }
  return pairs;
}

int predict_octave(const Landmark& landmark, double distance, const ScaleLevels& levels) {
  int octave = 0;
  double reach = distance;
  for (; octave < levels.levels - 1 && reach < landmark.max_distance; ++octave) {
    reach *= levels.factor;
  }
  return octave;
}

bool expect_landmark(const Landmark& landmark, const Camera& camera, const Pose& cam_from_world,
                     const ScaleLevels& levels, Expectation& expectation) {
  constexpr double kMinViewCosine = 0.5;  // 60 degrees [K]
  constexpr double kRangeSlack = 1.2;     // the range of distances, widened [K]
  const Eigen::Vector3d point_cam = cam_from_world * landmark.position;
  if (point_cam.z() <= 0.0) return false;
  const Eigen::Vector2d pixel = camera.project(point_cam);
  if (!camera.contains(pixel)) return false;
  const double distance = point_cam.norm();
  if (distance > kRangeSlack * landmark.max_distance ||
      distance < landmark.min_distance / kRangeSlack) {
    return false;
  }
  const Eigen::Vector3d view_from_world =
      cam_from_world.linear().transpose() * (-point_cam / distance);
  const double cosine = view_from_world.dot(landmark.view_from);
  if (cosine < kMinViewCosine) return false;

  const int octave = predict_octave(landmark, distance, levels);
  expectation.landmark = landmark.id;
  expectation.pixel = pixel;
  expectation.radius_px = (cosine > 0.998 ? 2.5 : 4.0) * levels.scale(octave);
  expectation.min_octave = octave - 1;
  expectation.max_octave = octave;
  expectation.descriptor = landmark.descriptor;
  expectation.angle_deg = -1.0F;
  return true;
}

std::vector<std::pair<int, int>> match_for_initialisation(const Features& ref, const Features& cur,
                                                          std::vector<Eigen::Vector2d>& guess,
                                                          double window_px) {
  Claims claims(cur.size());
  std::vector<int> candidates;
  for (int i = 0; i < ref.size(); ++i) {
    const auto r = static_cast<std::size_t>(i);
    if (ref.keypoints[r].octave > 0) continue;
    candidates.clear();
    cur.find_in_area(guess[r], window_px, 0, 0, candidates);
    Best best;
    for (const int candidate : candidates) {
      best.offer(candidate,
                 hamming_distance(ref.descriptors[r],
                                  cur.descriptors[static_cast<std::size_t>(candidate)]),
                 0);
    }
    if (best.distance <= kStrictDistance && best.distance < 0.9 * best.second_distance) {
      claims.claim(i, best.index, best.distance);
    }
  }
  std::vector<std::pair<int, int>> pairs = swapped_and_sorted(claims.pairs());
  keep_dominant_rotation(pairs, [&](const auto& pair) {
    return rotation_bin(ref.keypoints[static_cast<std::size_t>(pair.first)].angle_deg,
                        cur.keypoints[static_cast<std::size_t>(pair.second)].angle_deg);
  });
  for (const auto& [i, j] : pairs) {
    guess[static_cast<std::size_t>(i)] =
        cur.keypoints[static_cast<std::size_t>(j)].pixel.cast<double>();
  }
  return pairs;
}

std::vector<std::pair<int, int>> match_brute_force(const Features& from,
                                                   const std::vector<char>& use_from,
                                                   const Features& to, int max_distance,
                                                   double ratio) {
  Claims claims(to.size());
  for (int i = 0; i < from.size(); ++i) {
    const auto f = static_cast<std::size_t>(i);
    if (!use_from.empty() && use_from[f] == 0) continue;
    Best best;
    for (int j = 0; j < to.size(); ++j) {
      best.offer(
          j, hamming_distance(from.descriptors[f], to.descriptors[static_cast<std::size_t>(j)]), 0);
    }
    if (best.distance <= max_distance && best.distance < ratio * best.second_distance) {
      claims.claim(i, best.index, best.distance);
    }
  }
  std::vector<std::pair<int, int>> pairs = swapped_and_sorted(claims.pairs());
  keep_dominant_rotation(pairs, [&](const auto& pair) {
    return rotation_bin(from.keypoints[static_cast<std::size_t>(pair.first)].angle_deg,
                        to.keypoints[static_cast<std::size_t>(pair.second)].angle_deg);
  });
  return pairs;
}

}  // namespace planecast::slam
