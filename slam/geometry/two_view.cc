#include "slam/geometry/two_view.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "slam/geometry/relative_pose.h"
#include "slam/geometry/triangulate.h"

namespace planecast::slam {
namespace {

constexpr double kChi2 = 5.991;  ///< 95 %, 2 degrees of freedom
/// Cosine of about 0.36 degrees, [K].
constexpr double kFarCosine = 0.99998;
/// The parallax of a pose is that of the point of this rank, [K].
constexpr std::size_t kParallaxRank = 50;
constexpr double kDegreesPerRadian = 57.29577951308232;

/// Squared distance in pixels between `to` and `from` sent through the homography.
double transfer_error(const Eigen::Matrix3d& h, const Eigen::Vector2d& from,
                      const Eigen::Vector2d& to) {
  const double w = h(2, 0) * from.x() + h(2, 1) * from.y() + h(2, 2);
  const double dx = (h(0, 0) * from.x() + h(0, 1) * from.y() + h(0, 2)) / w - to.x();
  const double dy = (h(1, 0) * from.x() + h(1, 1) * from.y() + h(1, 2)) / w - to.y();
  return dx * dx + dy * dy;
}

struct Witness {
  bool good = false;
  bool far = false;
  double cosine = 1.0;
  Eigen::Vector3d point_ref = Eigen::Vector3d::Zero();
};

/// What one pair says of one candidate pose.
class PoseJudge {
 public:
  PoseJudge(const Pose& cur_from_ref, const Camera& camera, double sigma_px)
      : pose_(cur_from_ref),
        essential_(essential_from_pose(cur_from_ref)),
        cur_centre_ref_(-(cur_from_ref.linear().transpose() * cur_from_ref.translation())),
        camera_(camera),
        max_error_(kChi2 * sigma_px * sigma_px) {}

  Witness judge(const PointPair& pair) const {
    Witness witness;
    const std::optional<Eigen::Vector3d> point =
        intersect_rays(pose_, essential_, camera_.ray(pair.ref), camera_.ray(pair.cur));
    if (!point) {
      witness.good = witness.far = true;
      return witness;
    }
    witness.point_ref = *point;
    const Eigen::Vector3d point_cur = pose_ * *point;
    const Eigen::Vector3d from_cur = *point - cur_centre_ref_;
    witness.cosine =
        point->dot(from_cur) / std::sqrt(point->squaredNorm() * from_cur.squaredNorm());
    witness.far = witness.cosine >= kFarCosine;
    if (!witness.far && !(point->z() > 0.0 && point_cur.z() > 0.0)) return witness;
    witness.good = (camera_.project(*point) - pair.ref).squaredNorm() <= max_error_ &&
                   (camera_.project(point_cur) - pair.cur).squaredNorm() <= max_error_;
    return witness;
  }

 private:
  Pose pose_;
  Eigen::Matrix3d essential_;
  Eigen::Vector3d cur_centre_ref_;
  const Camera& camera_;
  double max_error_;
};

int count_good(const PoseJudge& judge, const std::vector<PointPair>& pairs,
               const std::vector<char>& inlier) {
  int good = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) good += inlier[i] && judge.judge(pairs[i]).good;
  return good;
}

/// Angle of the `rank`-th largest, or of the smallest where there are fewer.
double ranked_parallax_deg(std::vector<double>& cosines, std::size_t rank) {
  if (cosines.empty()) return 0.0;
  const auto nth =
      cosines.begin() + static_cast<std::ptrdiff_t>(std::min(rank, cosines.size()) - 1);
  std::nth_element(cosines.begin(), nth, cosines.end());
  return std::acos(std::clamp(*nth, -1.0, 1.0)) * kDegreesPerRadian;
}

/// Fills pose, points, parallax and count of the result; returns which pairs are good.
std::vector<char> describe(const Pose& pose, const std::vector<PointPair>& pairs,
                           const std::vector<char>& inlier, const Camera& camera, double sigma_px,
                           TwoViewResult& result) {
  const PoseJudge judge(pose, camera, sigma_px);
  std::vector<char> good(pairs.size(), 0);
  std::vector<double> cosines;
  std::vector<double> near_cosines;
  result.cur_from_ref = pose;
  result.points_ref.assign(pairs.size(), std::nullopt);
  result.good = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!inlier[i]) continue;
    const Witness witness = judge.judge(pairs[i]);
    if (!witness.good) continue;
    good[i] = 1;
    ++result.good;
    cosines.push_back(witness.cosine);
    if (witness.far) continue;
    result.points_ref[i] = witness.point_ref;
    near_cosines.push_back(witness.cosine);
  }
  result.parallax_deg = ranked_parallax_deg(cosines, kParallaxRank);
  result.median_parallax_deg = ranked_parallax_deg(near_cosines, near_cosines.size() / 2 + 1);
  return good;
}

TwoViewFailure verdict(const TwoViewResult& result, int inliers, const TwoViewOptions& options) {
  if (result.good < options.min_points || result.good < options.min_good_ratio * inliers) {
    return TwoViewFailure::kTooFewPoints;
  }
  // A few near points may show parallax where the depths of most are still anybody's guess.
  if (std::min(result.parallax_deg, result.median_parallax_deg) < options.min_parallax_deg) {
    return TwoViewFailure::kTooLittleParallax;
  }
  if (result.runner_up_good >= options.max_runner_up_ratio * result.good) {
    return TwoViewFailure::kAmbiguous;
  }
  const auto points = std::count_if(result.points_ref.begin(), result.points_ref.end(),
                                    [](const auto& point) { return point.has_value(); });
  return points < options.min_points ? TwoViewFailure::kTooFewPoints : TwoViewFailure::kNone;
}

}  // namespace

double score_homography(const Eigen::Matrix3d& cur_H_ref, const std::vector<PointPair>& pairs,
                        double sigma_px, std::vector<char>* inlier) {
  if (inlier != nullptr) inlier->assign(pairs.size(), 0);
  const Eigen::Matrix3d ref_H_cur = cur_H_ref.inverse();
  if (!ref_H_cur.allFinite()) return 0.0;
  const double inverse_variance = 1.0 / (sigma_px * sigma_px);
  double score = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double forward = inverse_variance * transfer_error(cur_H_ref, pairs[i].ref, pairs[i].cur);
    const double back = inverse_variance * transfer_error(ref_H_cur, pairs[i].cur, pairs[i].ref);
    if (forward < kChi2) score += kChi2 - forward;
    if (back < kChi2) score += kChi2 - back;
    if (inlier != nullptr) (*inlier)[i] = forward < kChi2 && back < kChi2;
  }
  return score;
}

TwoViewResult select_relative_pose(const std::vector<Pose>& candidates,
                                   const std::vector<PointPair>& pairs,
                                   const std::vector<char>& inlier, const Camera& camera,
                                   const TwoViewOptions& options) {
  TwoViewResult result;
  result.points_ref.assign(pairs.size(), std::nullopt);
  const int inliers = static_cast<int>(
      std::count_if(inlier.begin(), inlier.end(), [](char is_inlier) { return is_inlier != 0; }));
  if (inliers < options.min_points) {
    result.failure = TwoViewFailure::kTooFewMatches;
    return result;
  }
  int best_good = 0;
  const Pose* best = nullptr;
  for (const Pose& candidate : candidates) {
    const int good = count_good(PoseJudge(candidate, camera, options.sigma_px), pairs, inlier);
    if (good > best_good) {
      result.runner_up_good = best_good;
      best_good = good;
      best = &candidate;
    } else {
      result.runner_up_good = std::max(result.runner_up_good, good);
    }
  }
  if (best == nullptr) {
    // A homography without candidates is a rotation, in which no pair has parallax.
    result.failure =
        candidates.empty() ? TwoViewFailure::kTooLittleParallax : TwoViewFailure::kTooFewPoints;
    return result;
  }
  const std::vector<char> good = describe(*best, pairs, inlier, camera, options.sigma_px, result);
  TwoViewResult refined = result;
  const Pose refined_pose = refine_relative_pose(*best, pairs, good, camera);
  describe(refined_pose, pairs, inlier, camera, options.sigma_px, refined);
  if (refined.good >= result.good) result = std::move(refined);
  result.failure = verdict(result, inliers, options);
  return result;
}

}  // namespace planecast::slam
