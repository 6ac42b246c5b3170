#include "slam/optimize/point_elimination.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "slam/data/vector_clones.h"

namespace planecast::slam {
namespace {

/// Points whose products are summed in single precision before they go into the sums.
constexpr int kPointsBetweenFlushes = 64;
/// Raises every diagonal a little: what nothing determines stays where it is.
constexpr double kLeastPointDiagonal = 1e-12;
constexpr double kLeastPoseDiagonal = 1e-9;

using Cross = PointElimination::Cross;
using FloatRow = PointElimination::FloatRow;
using Point = PointElimination::Point;

/// 1 / sqrt, or 0 for what is not positive: no movement along that direction.
double inverse_root(double pivot) { return pivot > 0.0 ? 1.0 / std::sqrt(pivot) : 0.0; }

Point factorise(const SightDerivatives* sights, std::size_t count, double damping) {
  double h00 = 0.0, h10 = 0.0, h11 = 0.0, h20 = 0.0, h21 = 0.0, h22 = 0.0;
  double g0 = 0.0, g1 = 0.0, g2 = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    for (int k = 0; k < sights[i].rows; ++k) {
      const double* d = sights[i].by_point[k];
      const double r = sights[i].residual[k];
      h00 += d[0] * d[0];
      h10 += d[1] * d[0];
      h11 += d[1] * d[1];
      h20 += d[2] * d[0];
      h21 += d[2] * d[1];
      h22 += d[2] * d[2];
      g0 += d[0] * r;
      g1 += d[1] * r;
      g2 += d[2] * r;
    }
  }
  const double raised = 1.0 + damping;
  Point point;
  point.inverse00 = inverse_root(raised * h00 + kLeastPointDiagonal);
  point.l10 = h10 * point.inverse00;
  point.l20 = h20 * point.inverse00;
  point.inverse11 = inverse_root(raised * h11 + kLeastPointDiagonal - point.l10 * point.l10);
  point.l21 = (h21 - point.l20 * point.l10) * point.inverse11;
  point.inverse22 = inverse_root(raised * h22 + kLeastPointDiagonal - point.l20 * point.l20 -
                                 point.l21 * point.l21);
  point.gradient[0] = g0 * point.inverse00;
  point.gradient[1] = (g1 - point.l10 * point.gradient[0]) * point.inverse11;
  point.gradient[2] =
      (g2 - point.l20 * point.gradient[0] - point.l21 * point.gradient[1]) * point.inverse22;
  return point;
}

/// Derivative of a sight by its whitened point: rows of J L^-T.
inline void whiten(const SightDerivatives& sight, const Point& point, double (&whitened)[3][3]) {
  for (int k = 0; k < sight.rows; ++k) {
    const double* d = sight.by_point[k];
    double* w = whitened[k];
    w[0] = d[0] * point.inverse00;
    w[1] = (d[1] - point.l10 * w[0]) * point.inverse11;
    w[2] = (d[2] - point.l20 * w[0] - point.l21 * w[1]) * point.inverse22;
  }
}

/// The pose's gradient once the point follows it.
inline void add_gradient(const SightDerivatives& sight, const Point& point,
                         const double (&whitened)[3][3], PoseStep& gradient) {
  for (int k = 0; k < sight.rows; ++k) {
    const double* w = whitened[k];
    const double left = sight.residual[k] - w[0] * point.gradient[0] - w[1] * point.gradient[1] -
                        w[2] * point.gradient[2];
    for (int c = 0; c < 6; ++c) gradient[c] += left * sight.by_pose[k][c];
  }
}

/// The sight's part in the pose's own block, and its block with the point.
inline void add_own(const SightDerivatives& sight, const double (&whitened)[3][3],
                    FloatRow& diagonal, FloatRow (&block)[6], Cross& cross) {
  FloatRow by_pose[3];
  for (int k = 0; k < sight.rows; ++k) {
    const double* d = sight.by_pose[k];
    by_pose[k] =
        FloatRow{static_cast<float>(d[0]), static_cast<float>(d[1]), static_cast<float>(d[2]),
                 static_cast<float>(d[3]), static_cast<float>(d[4]), static_cast<float>(d[5])};
    diagonal += by_pose[k] * by_pose[k];
    for (int r = 0; r < 6; ++r) block[r] += by_pose[k][r] * by_pose[k];
  }
  for (int m = 0; m < 3; ++m) {
    FloatRow row = static_cast<float>(whitened[0][m]) * by_pose[0];
    for (int k = 1; k < sight.rows; ++k) row += static_cast<float>(whitened[k][m]) * by_pose[k];
    cross.row[m] = row;
  }
}

inline void subtract_product(const Cross& left, const Cross& right, FloatRow (&block)[6]) {
  for (int r = 0; r < 6; ++r) {
    block[r] -= left.row[0][r] * right.row[0] + left.row[1][r] * right.row[1] +
                left.row[2][r] * right.row[2];
  }
}

}  // namespace

PointElimination::PointElimination(std::size_t free_poses)
    : free_(free_poses),
      gradients_(free_poses),
      diagonals_(free_poses),
      blocks_(free_poses * free_poses),
      sums_(36 * free_poses * free_poses) {}

void PointElimination::begin(double damping) {
  damping_ = damping;
  expected_decrease_ = pose_decrease_ = 0.0;
  unflushed_ = 0;
  gradients_.assign(free_, PoseStep::Zero());
  diagonals_.assign(free_, Diagonal{});
  blocks_.assign(free_ * free_, Block{});
  sums_.assign(36 * free_ * free_, 0.0);
}

PLANECAST_VECTOR_CLONES
void PointElimination::add_point(const SightDerivatives* sights, std::size_t count, Cross* cross,
                                 Point& point) {
  point = factorise(sights, count, damping_);
  for (const double whitened : point.gradient) expected_decrease_ += whitened * whitened;
  for (std::size_t i = 0; i < count; ++i) {
    if (sights[i].slot == kNone) continue;
    if (sights[i].rows == 0) {
      cross[i] = Cross{};
      continue;
    }
    const auto slot = static_cast<std::size_t>(sights[i].slot);
    Block* row = blocks_.data() + slot * free_;
    double whitened[3][3];
    whiten(sights[i], point, whitened);
    add_gradient(sights[i], point, whitened, gradients_[slot]);
    add_own(sights[i], whitened, diagonals_[slot].row, row[slot].row, cross[i]);
    // Sights ascend, so that this is the upper triangle, column by column.
    for (std::size_t j = 0; j <= i; ++j) {
      if (sights[j].slot == kNone || sights[j].rows == 0) continue;
      subtract_product(cross[j], cross[i],
                       blocks_[static_cast<std::size_t>(sights[j].slot) * free_ + slot].row);
    }
  }
  if (++unflushed_ == kPointsBetweenFlushes) flush();
}

void PointElimination::flush() {
  unflushed_ = 0;
  for (std::size_t row = 0; row < free_; ++row) {
    for (std::size_t column = row; column < free_; ++column) {
      const std::size_t index = row * free_ + column;
      double* sum = sums_.data() + 36 * index;
      for (int r = 0; r < 6; ++r) {
        for (int c = 0; c < 6; ++c) sum[6 * r + c] += static_cast<double>(blocks_[index].row[r][c]);
      }
      blocks_[index] = Block{};
    }
  }
}

bool PointElimination::solve() {
  if (free_ == 0) return true;
  flush();
  const auto size = static_cast<Eigen::Index>(6 * free_);
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd gradient(size);
  for (std::size_t row = 0; row < free_; ++row) {
    const auto r = static_cast<Eigen::Index>(6 * row);
    for (std::size_t column = row; column < free_; ++column) {
      using Map66 = Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>;
      system.block<6, 6>(r, static_cast<Eigen::Index>(6 * column)) =
          Map66(sums_.data() + 36 * (row * free_ + column));
    }
    for (int i = 0; i < 6; ++i) {
      system(r + i, r + i) +=
          damping_ * static_cast<double>(diagonals_[row].row[i]) + kLeastPoseDiagonal;
    }
    gradient.segment<6>(r) = gradients_[row];
  }
  solution_ = -system.selfadjointView<Eigen::Upper>().ldlt().solve(gradient);
  pose_decrease_ = -solution_.dot(gradient);
  expected_decrease_ += pose_decrease_;
  return solution_.allFinite();
}

Eigen::Vector3d PointElimination::point_step(const Point& point, const int* slots,
                                             const Cross* cross, std::size_t count) const {
  double y[3] = {point.gradient[0], point.gradient[1], point.gradient[2]};
  for (std::size_t i = 0; i < count; ++i) {
    if (slots[i] == kNone) continue;
    const double* step = solution_.data() + 6 * slots[i];
    for (int m = 0; m < 3; ++m) {
      for (int c = 0; c < 6; ++c) y[m] += static_cast<double>(cross[i].row[m][c]) * step[c];
    }
  }
  // The transposed factor, from its last row.
  const double z = y[2] * point.inverse22;
  const double x1 = (y[1] - point.l21 * z) * point.inverse11;
  const double x0 = (y[0] - point.l10 * x1 - point.l20 * z) * point.inverse00;
  return {-x0, -x1, -z};
}

}  // namespace planecast::slam
