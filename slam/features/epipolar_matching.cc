#include <algorithm>
#include <cmath>

#include "slam/features/matching.h"
#include "slam/geometry/triangulate.h"

namespace planecast::slam {
namespace {

/// Keypoints of b without a landmark, by their place in stripes across the image, so that only
/// those near an epipolar line are looked at.
class StripeIndex {
 public:
  StripeIndex(const Keyframe& keyframe, bool by_row, int extent_px)
      : by_row_(by_row), stripes_(static_cast<std::size_t>(extent_px / kStripePx + 1)) {
    for (int k = 0; k < keyframe.features->size(); ++k) {
      if (keyframe.landmarks[static_cast<std::size_t>(k)] != kNone) continue;
      const Eigen::Vector2f& pixel =
          keyframe.features->keypoints[static_cast<std::size_t>(k)].pixel;
      stripes_[clamp(by_row ? pixel.y() : pixel.x())].push_back(
          {k, by_row ? pixel.x() : pixel.y()});
    }
    for (auto& stripe : stripes_) {
      std::sort(stripe.begin(), stripe.end(), [](const Entry& a, const Entry& b) {
        return a.along != b.along ? a.along < b.along : a.keypoint < b.keypoint;
      });
    }
  }

  /// Calls visit(keypoint) for those within `reach_px` of the line a x + b y + c = 0.
  template <typename Visit>
  void visit_near(const Eigen::Vector3d& line, double reach_px, const Visit& visit) const {
    const double across = by_row_ ? line.y() : line.x();  // coefficient of the stripes' coordinate
    const double along = by_row_ ? line.x() : line.y();
    for (std::size_t s = 0; s < stripes_.size(); ++s) {
      const double begin = static_cast<double>(s) * kStripePx;
      const double end = begin + kStripePx;
      const double at_begin = -(across * begin + line.z()) / along;
      const double at_end = -(across * end + line.z()) / along;
      const double slack = reach_px * std::hypot(across, along) / std::abs(along);
      const double low = std::min(at_begin, at_end) - slack;
      const double high = std::max(at_begin, at_end) + slack;
      auto entry = std::lower_bound(stripes_[s].begin(), stripes_[s].end(), low,
                                    [](const Entry& e, double value) { return e.along < value; });
      for (; entry != stripes_[s].end() && entry->along <= high; ++entry) visit(entry->keypoint);
    }
  }

 private:
  static constexpr int kStripePx = 16;
  struct Entry {
    int keypoint;
    float along;
  };
  std::size_t clamp(float value) const {
    const int stripe = static_cast<int>(std::floor(value / kStripePx));
    return static_cast<std::size_t>(std::clamp(stripe, 0, static_cast<int>(stripes_.size()) - 1));
  }
  bool by_row_;
  std::vector<std::vector<Entry>> stripes_;
};

}  // namespace

std::vector<std::pair<int, int>> match_along_epipolar(const Keyframe& a, const Keyframe& b,
                                                      const Camera& camera,
                                                      const ScaleLevels& levels) {
  constexpr double kChi2 = 3.84;  // 95 %, one degree of freedom
  const Eigen::Matrix3d b_F_a = fundamental_from_poses(camera, a.cam_from_world, b.cam_from_world);
  const Eigen::Vector3d epipole_cam = b.cam_from_world * a.centre_world();
  const bool epipole_in_front = epipole_cam.z() > 1e-9;
  const Eigen::Vector2d epipole =
      epipole_in_front ? camera.project(epipole_cam) : Eigen::Vector2d::Zero();

  const StripeIndex rows(b, true, camera.height);
  const StripeIndex columns(b, false, camera.width);
  const double max_reach_px = std::sqrt(kChi2) * levels.sigma_px(levels.levels - 1);
  std::vector<int> claimed_by(static_cast<std::size_t>(b.features->size()), -1);
  std::vector<int> claimed_distance(static_cast<std::size_t>(b.features->size()), 257);
  for (int i = 0; i < a.features->size(); ++i) {
    const auto ia = static_cast<std::size_t>(i);
    if (a.landmarks[ia] != kNone) continue;
    const Keypoint& from = a.features->keypoints[ia];
    const Eigen::Vector3d line = b_F_a * Eigen::Vector3d(from.pixel.x(), from.pixel.y(), 1.0);
    const double norm2 = line.head<2>().squaredNorm();
    if (norm2 < 1e-20) continue;
    int best = -1;
    int best_distance = kStrictDistance + 1;
    const auto visit = [&](int j) {
      const auto jb = static_cast<std::size_t>(j);
      const Keypoint& to = b.features->keypoints[jb];
      const Eigen::Vector2d pixel = to.pixel.cast<double>();
      const double sigma = levels.sigma_px(to.octave);
      const double residual = line.x() * pixel.x() + line.y() * pixel.y() + line.z();
      if (residual * residual > kChi2 * sigma * sigma * norm2) return;
      // Near the epipole the depth is undetermined.
      if (epipole_in_front && (pixel - epipole).squaredNorm() < 100.0 * levels.scale(to.octave)) {
        return;
      }
      const int distance =
          hamming_distance(a.features->descriptors[ia], b.features->descriptors[jb]);
      if (distance < best_distance || (distance == best_distance && j < best)) {
        best = j;
        best_distance = distance;
      }
    };
    if (std::abs(line.x()) > std::abs(line.y())) {
      rows.visit_near(line, max_reach_px, visit);
    } else {
      columns.visit_near(line, max_reach_px, visit);
    }
    if (best < 0) continue;
    const auto claim = static_cast<std::size_t>(best);
    if (best_distance < claimed_distance[claim]) {
      claimed_distance[claim] = best_distance;
      claimed_by[claim] = i;
    }
  }
  std::vector<std::pair<int, int>> pairs;
  for (std::size_t j = 0; j < claimed_by.size(); ++j) {
    if (claimed_by[j] >= 0) pairs.emplace_back(claimed_by[j], static_cast<int>(j));
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace planecast::slam
