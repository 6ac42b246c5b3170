#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <array>
#include <cmath>
#include <utility>

#include "slam/geometry/random.h"
#include "slam/geometry/two_view.h"

namespace planecast::slam {
namespace {

constexpr int kSampleSize = 8;
constexpr double kScoreChi2 = 5.991;  ///< 95 %, 2 degrees of freedom: makes S_F comparable with S_H
constexpr double kGateChi2 = 3.841;   ///< 95 %, 1 degree of freedom
/// Least-squares fits to the inliers of each new best hypothesis.
constexpr int kLocalRefits = 2;

using Row9 = Eigen::Matrix<double, 1, 9>;

/// Translation and scale that give points zero mean and mean distance sqrt(2) (Hartley 1997).
struct Normaliser {
  double scale = 1.0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();

  Eigen::Vector2d operator()(const Eigen::Vector2d& point) const { return scale * (point - mean); }
  Eigen::Matrix3d matrix() const {
    return (Eigen::Matrix3d() << scale, 0, -scale * mean.x(), 0, scale, -scale * mean.y(), 0, 0, 1)
        .finished();
  }
};

Normaliser normaliser_of(const std::vector<PointPair>& pairs, Eigen::Vector2d PointPair::*side) {
  Normaliser normaliser;
  for (const PointPair& pair : pairs) normaliser.mean += pair.*side;
  normaliser.mean /= static_cast<double>(pairs.size());
  double distance = 0.0;
  for (const PointPair& pair : pairs) distance += (pair.*side - normaliser.mean).norm();
  if (distance > 0.0)
    normaliser.scale = std::sqrt(2.0) * static_cast<double>(pairs.size()) / distance;
  return normaliser;
}

/// Coefficients of x_cur^T F x_ref with F row by row.
Row9 epipolar_row(const PointPair& pair) {
  const double x = pair.ref.x(), y = pair.ref.y(), u = pair.cur.x(), v = pair.cur.y();
  return (Row9() << u * x, u * y, u, v * x, v * y, v, x, y, 1.0).finished();
}

Eigen::Matrix3d with_rank_two(const Eigen::Matrix<double, 9, 1>& f) {
  const Eigen::Matrix3d full =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(f.data());
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(full, Eigen::ComputeFullV);
  const Eigen::Vector3d null_direction = svd.matrixV().col(2);
  return full - (full * null_direction) * null_direction.transpose();
}

/// The scoring of S_F, with the matrix's columns and rows at hand.
class FundamentalScorer {
 public:
  FundamentalScorer(const std::vector<PointPair>& pairs, double sigma_px)
      : pairs_(pairs), inverse_variance_(1.0 / (sigma_px * sigma_px)) {}

  /// Stops, with what it has by then, as soon as `to_beat` is out of reach.
  double score(const Eigen::Matrix3d& f, double to_beat) const {
    double total = 0.0;
    double reachable = 2.0 * kScoreChi2 * static_cast<double>(pairs_.size());
    for (const PointPair& pair : pairs_) {
      const auto [chi2_cur, chi2_ref] = chi2(f, pair);
      if (chi2_cur <= kGateChi2) total += kScoreChi2 - chi2_cur;
      if (chi2_ref <= kGateChi2) total += kScoreChi2 - chi2_ref;
      reachable -= 2.0 * kScoreChi2;
      if (total + reachable <= to_beat) break;
    }
    return total;
  }

  void mark_inliers(const Eigen::Matrix3d& f, std::vector<char>& inlier) const {
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const auto [chi2_cur, chi2_ref] = chi2(f, pairs_[i]);
      inlier[i] = chi2_cur <= kGateChi2 && chi2_ref <= kGateChi2;
    }
  }

 private:
  /// Squared distances to the epipolar lines, over the variance.
  std::pair<double, double> chi2(const Eigen::Matrix3d& f, const PointPair& pair) const {
    const double x = pair.ref.x(), y = pair.ref.y(), u = pair.cur.x(), v = pair.cur.y();
    const double a = f(0, 0) * x + f(0, 1) * y + f(0, 2);
    const double b = f(1, 0) * x + f(1, 1) * y + f(1, 2);
    const double c = f(2, 0) * x + f(2, 1) * y + f(2, 2);
    const double a_ref = f(0, 0) * u + f(1, 0) * v + f(2, 0);
    const double b_ref = f(0, 1) * u + f(1, 1) * v + f(2, 1);
    const double algebraic = u * a + v * b + c;
    const double numerator = algebraic * algebraic * inverse_variance_;
    return {numerator / (a * a + b * b), numerator / (a_ref * a_ref + b_ref * b_ref)};
  }

  const std::vector<PointPair>& pairs_;
  double inverse_variance_;
};

/// Eight-point fits in normalised coordinates, given back in pixels.
class EightPoint {
 public:
  explicit EightPoint(const std::vector<PointPair>& pairs) : normalised_(pairs) {
    const Normaliser ref = normaliser_of(pairs, &PointPair::ref);
    const Normaliser cur = normaliser_of(pairs, &PointPair::cur);
    for (PointPair& pair : normalised_) pair = {ref(pair.ref), cur(pair.cur)};
    ref_ = ref.matrix();
    cur_transposed_ = cur.matrix().transpose();
  }

  Eigen::Matrix3d fit(const std::array<int, kSampleSize>& sample) const {
    Eigen::Matrix<double, 9, kSampleSize> columns;
    for (int i = 0; i < kSampleSize; ++i) {
      columns.col(i) =
          epipolar_row(normalised_[static_cast<std::size_t>(sample[static_cast<std::size_t>(i)])])
              .transpose();
    }
    // The last column of Q is orthogonal to all eight equations.
    const Eigen::HouseholderQR<Eigen::Matrix<double, 9, kSampleSize>> qr(columns);
    Eigen::Matrix<double, 9, 1> null_vector = Eigen::Matrix<double, 9, 1>::Unit(8);
    null_vector.applyOnTheLeft(qr.householderQ());
    return in_pixels(null_vector);
  }

  Eigen::Matrix3d fit_to_inliers(const std::vector<char>& inlier) const {
    Eigen::Matrix<double, 9, 9> normal = Eigen::Matrix<double, 9, 9>::Zero();
    for (std::size_t i = 0; i < normalised_.size(); ++i) {
      if (!inlier[i]) continue;
      const Row9 row = epipolar_row(normalised_[i]);
      normal.noalias() += row.transpose() * row;
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> solver(normal);
    return in_pixels(solver.eigenvectors().col(0));
  }

 private:
  Eigen::Matrix3d in_pixels(const Eigen::Matrix<double, 9, 1>& f) const {
    return cur_transposed_ * with_rank_two(f) * ref_;
  }

  std::vector<PointPair> normalised_;
  Eigen::Matrix3d ref_;
  Eigen::Matrix3d cur_transposed_;
};

}  // namespace

std::optional<FundamentalResult> find_fundamental(const std::vector<PointPair>& pairs,
                                                  const FundamentalOptions& options) {
  if (pairs.size() < kSampleSize) return std::nullopt;
  const EightPoint eight_point(pairs);
  const FundamentalScorer scorer(pairs, options.sigma_px);
  Random random(options.seed);
  FundamentalResult best;
  best.cur_F_ref.setZero();
  best.inlier.assign(pairs.size(), 0);
  std::vector<char> inlier(pairs.size(), 0);
  const auto keep_if_better = [&](const Eigen::Matrix3d& f) {
    const double score = scorer.score(f, best.score);
    if (!(score > best.score)) return false;
    best.cur_F_ref = f;
    best.score = score;
    return true;
  };
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    std::array<int, kSampleSize> sample;
    random.distinct(kSampleSize, static_cast<int>(pairs.size()), sample.data());
    bool improved = keep_if_better(eight_point.fit(sample));
    for (int refit = 0; improved && refit < kLocalRefits; ++refit) {
      scorer.mark_inliers(best.cur_F_ref, inlier);
      improved = keep_if_better(eight_point.fit_to_inliers(inlier));
    }
  }
  if (best.score <= 0.0) return std::nullopt;
  scorer.mark_inliers(best.cur_F_ref, best.inlier);
  return best;
}

}  // namespace planecast::slam
