#include "slam/stages/align_frame.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "slam/features/pyramid.h"
#include "slam/features/sample_square.h"
#include "slam/geometry/lens.h"
#include "slam/geometry/pose_system.h"

namespace planecast::slam {
namespace {

constexpr int kSide = 4;
constexpr int kArea = kSide * kSide;
/// Mean absolute difference of a point's patch, in grey values, beyond which its weight falls
/// (Huber).
constexpr float kRobustGrey = 10.0F;
/// A step that would move the points further than this, in pixels of its level, has run away.
constexpr double kRunaway = 12.0;

using Patch = Eigen::Array<float, kArea, 1>;

/// A point with its looks in the frame before, at one level.
struct Point {
  Eigen::Vector3d before;  ///< in that camera
  Patch value;
  Patch grad_x;
  Patch grad_y;
  Eigen::Matrix<float, 2, 6> raw_by_step;  ///< pixels of the level
  Eigen::Matrix<float, 6, 6> hessian;
};

int shorter_side(const cv::Mat& image) { return std::min(image.cols, image.rows); }

class Level {
 public:
  Level(const Camera& camera, const cv::Mat& before, const cv::Mat& image, int level)
      : camera_(camera), image_(image), before_(before), level_(level) {}

  void add(const Eigen::Vector3d& point_before) {
    Point point;
    point.before = point_before;
    constexpr int kRim = kSide + 2;
    Eigen::Array<float, kRim * kRim, 1> rim;
    if (!sample_square<kRim>(before_, pixel_of(point_before), rim)) return;
    for (int v = 0; v < kSide; ++v) {
      for (int u = 0; u < kSide; ++u) {
        const int r = (v + 1) * kRim + u + 1;
        point.value[v * kSide + u] = rim[r];
        point.grad_x[v * kSide + u] = 0.5F * (rim[r + 1] - rim[r - 1]);
        point.grad_y[v * kSide + u] = 0.5F * (rim[r + kRim] - rim[r - kRim]);
      }
    }
    const Eigen::Matrix<double, 2, 3> raw_by_point =
        raw_by_undistorted(camera_, camera_.project(point_before)) *
        pixel_by_point(camera_, point_before) / (1 << level_);
    for (int row = 0; row < 2; ++row) {
      point.raw_by_step.row(row) =
          PoseSystem::jacobian(point_before, raw_by_point.row(row).transpose())
              .cast<float>()
              .transpose();
    }
    Eigen::Matrix2f moments;
    moments(0, 0) = point.grad_x.square().sum();
    moments(1, 1) = point.grad_y.square().sum();
    moments(0, 1) = moments(1, 0) = (point.grad_x * point.grad_y).sum();
    point.hessian = point.raw_by_step.transpose() * moments * point.raw_by_step;
    points_.push_back(point);
  }

  /// Gauss-Newton from `cam_from_before`; false where it fails.
  bool refine(Pose& cam_from_before, const AlignFrameOptions& options) {
    if (static_cast<int>(points_.size()) < options.min_points) return false;
    for (int i = 0; i < options.iterations; ++i) {
      Eigen::Matrix<double, 6, 1> step;
      if (!solve(cam_from_before, options.min_points, step)) return false;
      // Inverse compositional: the step was found for the frame before, and is undone here.
      cam_from_before = cam_from_before * stepped(Pose::Identity(), step).inverse();
      const double moved = mean_movement(step);
      if (!(moved < kRunaway)) return false;
      if (moved < options.converged_px) break;
    }
    return true;
  }

 private:
  Eigen::Vector2f pixel_of(const Eigen::Vector3d& point_cam) const {
    return at_level(project_raw(camera_, point_cam).cast<float>(), level_);
  }

  double mean_movement(const Eigen::Matrix<double, 6, 1>& step) const {
    double sum = 0.0;
    for (const Point& point : points_) sum += (point.raw_by_step.cast<double>() * step).norm();
    return sum / static_cast<double>(points_.size());
  }

  /// The gain and offset that make the image's patches like those before, as a whole.
  void sample_all(const Pose& cam_from_before) {
    current_.resize(points_.size());
    in_view_.assign(points_.size(), 0);
    double sum = 0.0, sum_before = 0.0, square = 0.0, square_before = 0.0;
    int count = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Eigen::Vector3d point = cam_from_before * points_[i].before;
      if (!(point.z() > 0.0)) continue;
      if (!sample_square<kSide>(image_, pixel_of(point), current_[i])) continue;
      in_view_[i] = 1;
      ++count;
      sum += static_cast<double>(current_[i].sum());
      square += static_cast<double>(current_[i].square().sum());
      sum_before += static_cast<double>(points_[i].value.sum());
      square_before += static_cast<double>(points_[i].value.square().sum());
    }
    count_ = count;
    if (count == 0) return;
    const double n = static_cast<double>(count) * kArea;
    const double variance = square / n - (sum / n) * (sum / n);
    const double variance_before = square_before / n - (sum_before / n) * (sum_before / n);
    const double gain = variance > 1.0 && variance_before > 1.0
                            ? std::clamp(std::sqrt(variance_before / variance), 0.5, 2.0)
                            : 1.0;
    gain_ = static_cast<float>(gain);
    offset_ = static_cast<float>((sum_before - gain * sum) / n);
  }

  bool solve(const Pose& cam_from_before, int min_points, Eigen::Matrix<double, 6, 1>& step) {
    sample_all(cam_from_before);
    if (count_ < min_points) return false;
    Eigen::Matrix<float, 6, 6> hessian = Eigen::Matrix<float, 6, 6>::Zero();
    Eigen::Matrix<float, 6, 1> gradient = Eigen::Matrix<float, 6, 1>::Zero();
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (in_view_[i] == 0) continue;
      const Point& point = points_[i];
      const Patch difference = gain_ * current_[i] + offset_ - point.value;
      const float mean = difference.abs().sum() / kArea;
      const float weight = mean > kRobustGrey ? kRobustGrey / mean : 1.0F;
      hessian += weight * point.hessian;
      const Eigen::Vector2f by_pixel((difference * point.grad_x).sum(),
                                     (difference * point.grad_y).sum());
      gradient += weight * (point.raw_by_step.transpose() * by_pixel);
    }
    step = hessian.cast<double>().ldlt().solve(gradient.cast<double>());
    return step.allFinite();
  }

  const Camera& camera_;
  const cv::Mat& image_;
  const cv::Mat& before_;
  int level_;
  std::vector<Point> points_;
  std::vector<Patch> current_;
  std::vector<char> in_view_;
  int count_ = 0;
  float gain_ = 1.0F;
  float offset_ = 0.0F;
};

}  // namespace

std::optional<Pose> align_frame(const Camera& camera, const ImagePyramid& before,
                                const std::vector<Eigen::Vector3d>& points_before,
                                const ImagePyramid& image, const Pose& guess_cam_from_before,
                                const AlignFrameOptions& options) {
  const auto coarsest = static_cast<int>(std::min(before.levels.size(), image.levels.size())) - 1;
  int finest = 0;
  while (finest < coarsest &&
         shorter_side(image.levels[static_cast<std::size_t>(finest)]) > options.finest_side_px) {
    ++finest;
  }
  Pose cam_from_before = guess_cam_from_before;
  bool found = false;
  for (int l = coarsest; l >= finest; --l) {
    const auto index = static_cast<std::size_t>(l);
    Level level(camera, before.levels[index], image.levels[index], l);
    for (const Eigen::Vector3d& point : points_before) {
      if (point.z() > 0.0) level.add(point);
    }
    Pose refined = cam_from_before;
    // A level that fails, as the coarsest may with its few pixels, leaves the guess to the next.
    if (!level.refine(refined, options)) continue;
    cam_from_before = refined;
    found = l == finest;
  }
  if (!found) return std::nullopt;
  return cam_from_before;
}

}  // namespace planecast::slam
