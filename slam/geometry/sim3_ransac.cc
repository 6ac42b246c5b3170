#include "slam/geometry/sim3_ransac.h"

#include <algorithm>
#include <cmath>

#include "slam/geometry/random.h"

namespace planecast::slam {
namespace {

constexpr int kSampleSize = 3;
constexpr double kMissProbability = 0.001;

bool near_pixel(const Camera& camera, const Eigen::Vector3d& point_cam,
                const Eigen::Vector2d& pixel, double sigma_px, double chi2) {
  if (point_cam.z() <= 0.0) return false;
  return (camera.project(point_cam) - pixel).squaredNorm() <= chi2 * sigma_px * sigma_px;
}

Similarity align(const std::vector<SimilarityPair>& pairs, const int* sample, bool with_scale) {
  std::vector<Eigen::Vector3d> source(kSampleSize);
  std::vector<Eigen::Vector3d> target(kSampleSize);
  for (std::size_t i = 0; i < kSampleSize; ++i) {
    const SimilarityPair& pair = pairs[static_cast<std::size_t>(sample[i])];
    source[i] = pair.point_b;
    target[i] = pair.point_a;
  }
  return align_points(source, target, with_scale);
}

int iterations_needed(double inlier_share) {
  const double miss = 1.0 - std::pow(inlier_share, kSampleSize);
  if (miss <= 0.0) return 1;
  if (miss >= 1.0) return 1 << 20;
  return static_cast<int>(std::min(1e6, std::ceil(std::log(kMissProbability) / std::log(miss))));
}

}  // namespace

bool agrees(const Camera& camera, const SimilarityPair& pair, const Similarity& a_from_b,
            double chi2) {
  return near_pixel(camera, a_from_b * pair.point_b, pair.pixel_a, pair.sigma_a_px, chi2) &&
         near_pixel(camera, a_from_b.inverse() * pair.point_a, pair.pixel_b, pair.sigma_b_px, chi2);
}

std::optional<SimilarityResult> solve_similarity(const Camera& camera,
                                                 const std::vector<SimilarityPair>& pairs,
                                                 const SimilarityOptions& options) {
  const auto count = static_cast<int>(pairs.size());
  const int least = std::max(kSampleSize, options.min_inliers);
  if (count < least) return std::nullopt;
  Random random(options.seed);
  SimilarityResult best;
  std::vector<char> inlier(pairs.size());
  int most = options.iterations;
  for (int iteration = 0; iteration < most; ++iteration) {
    int sample[kSampleSize];
    random.distinct(kSampleSize, count, sample);
    const Similarity candidate = align(pairs, sample, options.with_scale);
    if (!candidate.translation.allFinite() || !(candidate.scale > 1e-6)) continue;
    int inliers = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      inlier[i] = agrees(camera, pairs[i], candidate, options.chi2) ? 1 : 0;
      inliers += inlier[i];
    }
    if (inliers <= best.num_inliers) continue;
    best = {candidate, inlier, inliers};
    most = std::min(options.iterations, iterations_needed(static_cast<double>(inliers) / count));
  }
  if (best.num_inliers < least) return std::nullopt;
  return best;
}

}  // namespace planecast::slam
