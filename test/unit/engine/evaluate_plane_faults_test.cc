#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>

#include "test/unit/engine/plane_evaluation_world.h"

namespace planecast::engine {
namespace {

constexpr double kRounding = 1e-9;

/// Every figure of a plane evaluation by name.
std::vector<std::pair<std::string, double>> figures_of(const PlaneResult& result) {
  return {{"ate", result.trajectory.ate.rms},
          {"scale", result.trajectory.truth_from_estimate.scale},
          {"precision", result.scores[0].precision},
          {"recall", result.scores[0].recall},
          {"tight precision", result.scores[1].precision},
          {"tight recall", result.scores[1].recall},
          {"over", result.scores[0].over_segmented},
          {"under", result.scores[0].under_segmented},
          {"angle", result.angle_deg.max},
          {"offset", result.offset_m.max},
          {"points", result.point_rms_m.rms},
          {"RI", result.labels.rand_index},
          {"VOI", result.labels.variation_of_information},
          {"SC", result.labels.segmentation_covering}};
}

/// A perfect map is spoilt in one way; which figures moved?
class PlaneFaults : public PlaneEvaluation {
 protected:
  std::vector<std::string> moved_since(const PlaneResult& before) const {
    const auto old_figures = figures_of(before);
    const auto figures = figures_of(evaluate());
    std::vector<std::string> moved;
    for (std::size_t i = 0; i < figures.size(); ++i) {
      if (std::abs(figures[i].second - old_figures[i].second) > 1e-6) {
        moved.push_back(figures[i].first);
      }
    }
    return moved;
  }
  using Names = std::vector<std::string>;
};

TEST_F(PlaneFaults, AFlippedNormalCostsPrecisionAndRecallAlone) {
  const PlaneResult before = evaluate();
  PlaneRecord& wall = estimate.planes[1];
  wall.normal = -wall.normal;
  wall.offset = -wall.offset;
  EXPECT_EQ(moved_since(before), (Names{"precision", "recall", "tight precision", "tight recall"}));
  // One of four planes is lost.
  EXPECT_NEAR(evaluate().scores[0].recall, 3.0 / 4.0, kRounding);
  EXPECT_NEAR(evaluate().scores[0].precision, 3.0 / 4.0, kRounding);
}

TEST_F(PlaneFaults, SwappedIdsOfPointsMoveThePointFiguresAlone) {
  const PlaneResult before = evaluate();
  // A tenth of the floor's points are said to be the wall's, and as many of the wall's the floor's.
  int to_swap_floor = 10;
  int to_swap_wall = 10;
  for (MapPoint& point : estimate.points) {
    if (point.plane == 10 && to_swap_floor > 0) {
      point.plane = 11;
      --to_swap_floor;
    } else if (point.plane == 11 && to_swap_wall > 0) {
      point.plane = 10;
      --to_swap_wall;
    }
  }
  EXPECT_EQ(moved_since(before), (Names{"points", "RI", "VOI", "SC"}));
  // 4 x 100 points. Pairs together on one side alone: of floor and wall each 90 x 10 in the truth
  // and the same in the estimate: 4 x 900 of 400 x 399 / 2 pairs.
  EXPECT_NEAR(evaluate().labels.rand_index, 1.0 - 3600.0 / 79800.0, kRounding);
  // Floor and wall: 90 of a union of 110 points; the tables whole.
  EXPECT_NEAR(evaluate().labels.segmentation_covering, 0.5 * 90.0 / 110.0 + 0.5, kRounding);
}

TEST_F(PlaneFaults, RenumberedPlanesMoveNothing) {
  const PlaneResult before = evaluate();
  // Two planes exchange their numbers, and their points with them: a name only.
  for (MapPoint& point : estimate.points) {
    if (point.plane == 10 || point.plane == 11) point.plane = 21 - point.plane;
  }
  std::swap(estimate.planes[0].id, estimate.planes[1].id);
  EXPECT_EQ(moved_since(before), Names{});
}

TEST_F(PlaneFaults, AScaledMonocularMapMovesTheScaleAlone) {
  const PlaneResult before = evaluate();
  constexpr double kFactor = 1.5;
  for (PlaneRecord& plane : estimate.planes) {
    plane.offset *= kFactor;
    plane.origin *= kFactor;
    for (Eigen::Vector3d& vertex : plane.polygon) vertex *= kFactor;
  }
  for (MapPoint& point : estimate.points) point.position *= kFactor;
  for (FrameRecord& frame : estimate.frames) frame.world_from_cam->translation() *= kFactor;
  EXPECT_EQ(moved_since(before), Names{"scale"});
  EXPECT_NEAR(evaluate().trajectory.truth_from_estimate.scale, 1.0 / (kMapScale * kFactor),
              kRounding);
}

TEST_F(PlaneFaults, PlanesScaledWithoutTheirTrajectoryAreOff) {
  // 2 % about the first camera: the floor, 1 m below it, is off by 2 cm, the wall at 4 m by 8 cm.
  const Eigen::Vector3d centre = estimate.frames.front().world_from_cam->translation();
  for (PlaneRecord& plane : estimate.planes) {
    const auto grown = [&centre](const Eigen::Vector3d& p) -> Eigen::Vector3d {
      return centre + 1.02 * (p - centre);
    };
    plane.offset = -plane.normal.dot(grown(-plane.offset * plane.normal));
    plane.origin = grown(plane.origin);
    for (Eigen::Vector3d& vertex : plane.polygon) vertex = grown(vertex);
  }
  const PlaneResult result = evaluate();
  // The first camera stands within 0.5 m of the true origin: a hundredth of a metre of slack.
  EXPECT_NEAR(std::abs(result.rows[0].offset_m), 0.02, 0.01);
  EXPECT_TRUE(result.rows[0].matched);
  EXPECT_NEAR(std::abs(result.rows[1].offset_m), 0.08, 0.01);
  EXPECT_FALSE(result.rows[1].matched);
}

TEST_F(PlaneFaults, AnInventedPlaneCostsPrecisionAlone) {
  const PlaneResult before = evaluate();
  PlaneRecord ghost = estimate.planes[1];
  ghost.id = 77;
  ghost.offset += 0.5 * kMapScale;  // half a metre behind the wall
  for (Eigen::Vector3d& vertex : ghost.polygon) vertex -= 0.5 * kMapScale * ghost.normal;
  ghost.origin -= 0.5 * kMapScale * ghost.normal;
  estimate.planes.push_back(ghost);
  EXPECT_EQ(moved_since(before), (Names{"precision", "tight precision"}));
  EXPECT_NEAR(evaluate().scores[0].precision, 4.0 / 5.0, kRounding);
}

}  // namespace
}  // namespace planecast::engine
