#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "slam/geometry/pose_system.h"

namespace planecast::slam {

/// One sight of a point: residuals over sigma, robustly weighted, and their derivatives by the
/// pose's step and by the point.
struct SightDerivatives {
  int slot = kNone;  ///< of the pose among the free ones; kNone = fixed
  int rows = 0;
  double residual[3];
  double by_pose[3][6];  ///< unset where the pose is fixed
  double by_point[3][3];
};

/// Normal equations in poses and points with the points eliminated one by one (Schur complement;
/// Triggs et al. 2000, section 6.1), so that a dense system in the poses is left.
///
/// Gradients and the points' own blocks are kept in double precision. The poses' blocks are made of
/// products in single precision, whitened by each point's Cholesky factor, and summed in double:
/// they decide how fast the steps lead to the minimum, not where that is.
class PointElimination {
 public:
  /// Eight columns for the six of a pose. Aligned as floats are, as containers may hold it.
  using FloatRow = float __attribute__((vector_size(32), aligned(4)));
  /// Block of point and pose, whitened by the point's factor.
  struct Cross {
    FloatRow row[3];
  };
  /// Inverse of the Cholesky factor of a point's block and the whitened gradient.
  struct Point {
    double inverse00, inverse11, inverse22, l10, l20, l21;
    double gradient[3];
  };

  explicit PointElimination(std::size_t free_poses);

  /// Starts anew. `damping`: share by which the diagonals are raised.
  void begin(double damping);
  /// Adds a point with its sights, which ascend by slot. Fills `cross` for those whose pose is
  /// free.
  void add_point(const SightDerivatives* sights, std::size_t count, Cross* cross, Point& point);
  /// Finds the poses' steps; false where there is no solution.
  bool solve();
  /// By how much the steps lower the sum of squares, were the residuals linear and undamped.
  double expected_decrease() const { return expected_decrease_; }
  /// The poses' part of it, once the points follow them: by the covariance that the sum of squares
  /// gives the poses, the squared length of their step.
  double pose_decrease() const { return pose_decrease_; }
  Eigen::Ref<const PoseStep> step(int slot) const { return solution_.segment<6>(6 * slot); }
  /// A point's step that follows from those of the poses that see it.
  Eigen::Vector3d point_step(const Point& point, const int* slots, const Cross* cross,
                             std::size_t count) const;

 private:
  struct Diagonal {
    FloatRow row = {};
  };
  struct Block {
    FloatRow row[6] = {};
  };
  void flush();

  std::size_t free_;
  double damping_ = 0.0;
  double expected_decrease_ = 0.0;
  double pose_decrease_ = 0.0;
  int unflushed_ = 0;
  std::vector<PoseStep> gradients_;  ///< per free pose
  std::vector<Diagonal> diagonals_;  ///< per free pose, before the points are eliminated
  std::vector<Block> blocks_;        ///< of the latest points: row by row, upper triangle
  std::vector<double> sums_;         ///< of those before: 36 for each block
  Eigen::VectorXd solution_;
};

}  // namespace planecast::slam
