#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "engine/evaluate/patch.h"
#include "engine/evaluate/plane_matching.h"
#include "test/unit/engine/plane_evaluation_world.h"

namespace planecast::engine {
namespace {

TEST_F(PlaneEvaluation, PerfectMapIsPerfect) {
  const PlaneResult result = evaluate();
  for (const PlaneScore& score : result.scores) {
    EXPECT_EQ(score.truth, 4);  // the wall behind was never seen
    EXPECT_DOUBLE_EQ(score.precision, 1.0);
    EXPECT_DOUBLE_EQ(score.recall, 1.0);
    EXPECT_DOUBLE_EQ(score.f, 1.0);
    EXPECT_EQ(score.over_segmented + score.under_segmented, 0);
  }
  EXPECT_NEAR(result.trajectory.truth_from_estimate.scale, 1.0 / kMapScale, 1e-9);
  EXPECT_NEAR(result.angle_deg.max, 0.0, 1e-6);
  EXPECT_NEAR(result.offset_m.max, 0.0, 1e-9);
  EXPECT_NEAR(result.point_rms_m.rms, 0.0, 1e-9);
  EXPECT_EQ(result.rows[1].estimate_id, 11);
  EXPECT_NEAR(result.rows[1].coverage, 1.0, 1e-9);
  EXPECT_FALSE(result.rows[4].required);
  EXPECT_DOUBLE_EQ(result.labels.rand_index, 1.0);
  EXPECT_NEAR(result.labels.variation_of_information, 0.0, 1e-12);
  EXPECT_DOUBLE_EQ(result.labels.segmentation_covering, 1.0);
}

TEST_F(PlaneEvaluation, LiftedPlaneFailsTheTighterToleranceFirst) {
  lift(1, 0.03);
  PlaneResult result = evaluate();
  EXPECT_DOUBLE_EQ(result.scores[0].recall, 1.0);
  EXPECT_DOUBLE_EQ(result.scores[1].recall, 0.75);
  EXPECT_DOUBLE_EQ(result.scores[1].precision, 0.75);
  EXPECT_NEAR(result.rows[1].offset_m, -0.03, 1e-9);
  EXPECT_NEAR(result.offset_m.max, 0.03, 1e-9);
  lift(1, 0.04);
  result = evaluate();
  EXPECT_DOUBLE_EQ(result.scores[0].recall, 0.75);
  EXPECT_FALSE(result.rows[1].matched);
  EXPECT_EQ(result.rows[1].estimate_id, 11);  // still shown as the nearest
}

TEST_F(PlaneEvaluation, FlippedNormalIsNoMatchAndShows180Degrees) {
  PlaneRecord& floor = estimate.planes[0];
  floor.normal = -floor.normal;
  floor.offset = -floor.offset;
  const PlaneResult result = evaluate();
  EXPECT_DOUBLE_EQ(result.scores[0].recall, 0.75);
  EXPECT_DOUBLE_EQ(result.scores[0].precision, 0.75);
  EXPECT_NEAR(result.rows[0].angle_deg, 180.0, 1e-6);
}

TEST_F(PlaneEvaluation, TiltIsMeasuredInDegrees) {
  PlaneRecord& wall = estimate.planes[1];
  const Eigen::AngleAxisd tilt(4.0 * M_PI / 180.0, wall.x_axis);
  wall.normal = tilt * wall.normal;
  wall.offset = -wall.normal.dot(wall.origin);  // about the patch's centroid: no offset there
  const PlaneResult result = evaluate();
  EXPECT_NEAR(result.rows[1].angle_deg, 4.0, 1e-6);
  EXPECT_NEAR(result.rows[1].offset_m, 0.0, 1e-9);
  EXPECT_TRUE(result.rows[1].matched);
}

TEST_F(PlaneEvaluation, PlanesWithoutLandmarksNeedNotBeFound) {
  EXPECT_EQ(evaluate().supported.truth, 4);
  EXPECT_EQ(evaluate().rows[1].landmarks, 100);
  const int lost = estimate.planes[1].id;
  estimate.planes.erase(estimate.planes.begin() + 1);
  int kept = 0;
  std::erase_if(estimate.points, [&](const MapPoint& p) { return p.plane == lost && ++kept > 23; });
  const PlaneResult result = evaluate();
  EXPECT_EQ(result.rows[1].landmarks, 23);
  EXPECT_EQ(result.supported.truth, 3);
  EXPECT_DOUBLE_EQ(result.supported.f, 1.0);
  EXPECT_DOUBLE_EQ(result.scores[0].recall, 0.75);
}

TEST_F(PlaneEvaluation, ScaledMapShowsUnderSe3) {
  PlaneEvaluationOptions options;
  options.trajectory.align = Alignment::kSe3;
  const auto result = evaluate_planes(estimate, truth, truth_poses, camera, options);
  ASSERT_TRUE(result);
  EXPECT_EQ(result->scores[0].found, 0);
  EXPECT_GT(result->trajectory.ate.rms, 0.1);
}

TEST_F(PlaneEvaluation, CoplanarTableTopsAreToldApart) {
  // The right table's estimate is missing: the left one must not stand for it.
  estimate.planes.erase(estimate.planes.begin() + 3);
  const PlaneResult result = evaluate();
  EXPECT_TRUE(result.rows[2].matched);
  EXPECT_FALSE(result.rows[3].matched);
  EXPECT_DOUBLE_EQ(result.scores[0].recall, 0.75);
  EXPECT_DOUBLE_EQ(result.scores[0].precision, 1.0);
}

TEST_F(PlaneEvaluation, MergedTableTopsAreUnderSegmentation) {
  const PlaneRecord& right = estimate.planes[3];
  PlaneRecord& left = estimate.planes[2];
  left.polygon = {left.polygon[0], right.polygon[1], right.polygon[2], left.polygon[3]};
  estimate.planes.pop_back();
  const PlaneResult result = evaluate();
  EXPECT_EQ(result.scores[0].under_segmented, 1);
  EXPECT_EQ(result.scores[0].matched, 3);
  EXPECT_DOUBLE_EQ(result.scores[0].recall, 0.75);
}

TEST_F(PlaneEvaluation, PlaneInTwoPiecesIsOverSegmentation) {
  PlaneRecord& whole = estimate.planes[1];
  PlaneRecord piece = whole;
  piece.id = 99;
  const Eigen::Vector3d low = 0.6 * whole.polygon[0] + 0.4 * whole.polygon[1];
  const Eigen::Vector3d high = 0.6 * whole.polygon[3] + 0.4 * whole.polygon[2];
  piece.polygon = {whole.polygon[0], low, high, whole.polygon[3]};
  whole.polygon = {low, whole.polygon[1], whole.polygon[2], high};
  estimate.planes.push_back(piece);
  const PlaneResult result = evaluate();
  EXPECT_EQ(result.scores[0].over_segmented, 1);
  EXPECT_EQ(result.scores[0].matched, 4);
  EXPECT_DOUBLE_EQ(result.scores[0].precision, 0.8);
  EXPECT_NEAR(result.rows[1].coverage, 0.6, 1.0 / 48.0);  // the larger piece, sampled on 48 cells
}

TEST_F(PlaneEvaluation, PlanesWithoutPolygonMatchByTheirPoints) {
  for (PlaneRecord& plane : estimate.planes) plane.polygon.clear();
  EXPECT_DOUBLE_EQ(evaluate().scores[1].f, 1.0);
}

TEST_F(PlaneEvaluation, LabelsDecideWhatWasSeen) {
  PlaneEvaluationOptions options;
  options.seen_labels = {{1, 2, 5}};  // planes 0, 1 and 4
  const auto result = evaluate_planes(estimate, truth, truth_poses, camera, options);
  ASSERT_TRUE(result);
  EXPECT_EQ(result->scores[0].truth, 3);
  EXPECT_EQ(result->scores[0].found, 2);
  EXPECT_EQ(result->scores[0].matched, 4);
}

TEST_F(PlaneEvaluation, TableAndJsonShowTheFigures) {
  const PlaneResult result = evaluate();
  EXPECT_NE(format_table(result).find("1.000"), std::string::npos);
  EXPECT_EQ(to_json(result).at("scores").at(0).at("matched"), 4);
  EXPECT_EQ(to_json(result).at("planes").size(), 5U);
}

TEST(PointLabels, HandComputed) {
  // Truth {a a b b}, estimate {x x x y}: pairs together 2 and 3, in both 1; RI = 1 - (3 + 2 - 2)
  // / 6.
  std::vector<MapPoint> points(4);
  for (int i = 0; i < 4; ++i) points[static_cast<std::size_t>(i)].plane = i < 3 ? 5 : 6;
  const PointLabelScore score = score_point_labels(points, {0, 0, 1, 1});
  EXPECT_DOUBLE_EQ(score.rand_index, 0.5);
  // H(truth) = ln 2; H(estimate) = ln 4 - 3/4 ln 3; joint {2,1,1}/4: 3/2 ln 2.
  const double voi = 3.0 * std::log(2.0) - std::log(2.0) - (std::log(4.0) - 0.75 * std::log(3.0));
  EXPECT_NEAR(score.variation_of_information, voi, 1e-12);
  // Best overlaps: a with x 2/3, b with y 1/2.
  EXPECT_NEAR(score.segmentation_covering, 0.5 * 2.0 / 3.0 + 0.5 * 0.5, 1e-12);
}

TEST(Patch, AreaCentroidAndHoles) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
  PlaneRecord plane = make_rectangle(0, {1.0, 2.0, 3.0}, -Eigen::Vector3d::UnitY(), x, 4.0, 2.0);
  plane.holes = {
      make_rectangle(0, {2.0, 2.0, 3.0}, -Eigen::Vector3d::UnitY(), x, 1.0, 1.0).polygon};
  plane.origin = {-3.0, 2.0, 1.0};  // anywhere on the plane
  const Patch patch(plane);
  EXPECT_NEAR(patch.area(), 7.0, 1e-12);
  EXPECT_LT((patch.centroid() - Eigen::Vector3d((8.0 * 1.0 - 2.0) / 7.0, 2.0, 3.0)).norm(), 1e-12);
  EXPECT_TRUE(patch.contains({1.0, 2.0, 3.0}));
  EXPECT_TRUE(patch.contains({1.0, 7.0, 3.0}));  // its foot
  EXPECT_FALSE(patch.contains({2.0, 2.0, 3.0}));
  EXPECT_FALSE(patch.contains({4.0, 2.0, 3.0}));
  EXPECT_EQ(patch.grid(8).size(), 64U - 8U);  // the hole covers 2 x 4 cells of 0.5 x 0.25
}

TEST_F(PlaneEvaluation, PerfectMapDoesNotDrift) {
  const OverlayResult result = drift();
  EXPECT_EQ(result.planes, 4);
  EXPECT_EQ(result.frames, 60);
  EXPECT_NEAR(result.aligned.drift_px.max, 0.0, 1e-6);
  EXPECT_NEAR(result.tapped.drift_px.max, 0.0, 1e-6);
  EXPECT_NEAR(result.aligned.jitter_px.max, 0.0, 1e-6);
}

TEST_F(PlaneEvaluation, ShiftedPrincipalPointIsDriftWithoutJitter) {
  estimate.camera.cx += 3.0;
  const OverlayResult result = drift();
  EXPECT_NEAR(result.aligned.drift_px.rms, 3.0, 1e-6);
  EXPECT_NEAR(result.aligned.drift_px.p95, 3.0, 1e-6);
  EXPECT_NEAR(result.aligned.jitter_px.max, 0.0, 1e-6);
}

TEST_F(PlaneEvaluation, ShakingCameraIsJitter) {
  // A turn by +-1 px of focal length on every other frame: second differences of 4 px.
  for (std::size_t i = 0; i < estimate.frames.size(); ++i) {
    const double angle = (i % 2 == 0 ? 1.0 : -1.0) / camera.fx;
    estimate.frames[i].world_from_cam->rotate(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()));
  }
  const OverlayResult result = drift();
  // A turn moves a pixel by fx (1 + x^2): up to 1.37 px at the border of this image.
  EXPECT_GT(result.aligned.drift_px.rms, 0.99);
  EXPECT_LT(result.aligned.drift_px.max, 1.4);
  EXPECT_GT(result.aligned.jitter_px.rms, 3.9);
  EXPECT_LT(result.aligned.jitter_px.rms, 5.5);
}

TEST_F(PlaneEvaluation, LiftedPlaneSlidesUnderTheCamera) {
  lift(0, 0.04);
  const OverlayResult result = drift();
  EXPECT_GT(result.aligned.drift_px.max, 4.0);
  EXPECT_GT(result.tapped.drift_px.max, 1.0);
  EXPECT_LT(result.tapped.drift_px.rms, result.aligned.drift_px.rms);
}

TEST_F(PlaneEvaluation, ScaleOfTheMapDoesNotMoveTappedContent) {
  OverlayOptions options;
  options.planes.trajectory.align = Alignment::kSe3;
  options.planes.tolerances[0] = {10.0, 10.0};  // matches whatever the scale
  options.planes.min_overlap = 0.0;
  const OverlayResult result = drift(options);
  ASSERT_GT(result.planes, 0);
  EXPECT_GT(result.aligned.drift_px.rms, 10.0);
}

TEST_F(PlaneEvaluation, CausalPosesAreJudgedOnDemand) {
  OverlayOptions options;
  options.causal = true;
  for (FrameRecord& frame : estimate.frames) {
    frame.causal_world_from_cam = frame.world_from_cam;
    frame.causal_world_from_cam->rotate(Eigen::AngleAxisd(0.01, Eigen::Vector3d::UnitY()));
  }
  EXPECT_GT(drift(options).aligned.drift_px.rms, 5.0);  // 0.01 rad x 525 px
  EXPECT_NEAR(drift().aligned.drift_px.rms, 0.0, 1e-6);
}

TEST_F(PlaneEvaluation, CausalPlanesAreThoseOfTheirTime) {
  // For half of the frames the whole map stood elsewhere; then a loop was closed.
  slam::Pose elsewhere = slam::Pose::Identity();
  elsewhere.translation() = Eigen::Vector3d(0.05, 0.02, -0.04);
  elsewhere.linear() = Eigen::AngleAxisd(0.05, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  MapChange first;
  MapChange second;
  second.frame_index = 30;
  second.new_from_old_world = elsewhere.inverse();
  for (const PlaneRecord& plane : estimate.planes) {
    first.planes.push_back({plane.id, elsewhere * plane.world_from_plane()});
    second.planes.push_back({plane.id, plane.world_from_plane()});
  }
  estimate.map_changes = {first, second};
  for (FrameRecord& frame : estimate.frames) {
    frame.causal_world_from_cam =
        frame.index < 30 ? elsewhere * *frame.world_from_cam : *frame.world_from_cam;
  }
  OverlayOptions options;
  options.causal = true;
  EXPECT_NEAR(drift(options).tapped.drift_px.max, 0.0, 1e-6);
  estimate.map_changes.clear();
  EXPECT_GT(drift(options).tapped.drift_px.max, 5.0);
}

TEST_F(PlaneEvaluation, NobodyTapsWhereTheMapHasNoSurface) {
  const int everywhere = drift().tapped.drift_px.count;
  // Only the nearer left half of the floor is known.
  const slam::Pose plane_from_world = estimate.planes[0].world_from_plane().inverse();
  for (Eigen::Vector3d& corner : estimate.planes[0].polygon) {
    Eigen::Vector3d local = plane_from_world * corner;
    local.x() = std::min(local.x(), 0.0);
    corner = plane_from_world.inverse() * local;
  }
  const OverlayResult result = drift();
  EXPECT_LT(result.tapped.drift_px.count, everywhere);
  EXPECT_EQ(result.aligned.drift_px.count, drift().aligned.drift_px.count);
}

TEST_F(PlaneEvaluation, NoMatchGivesEmptyFigures) {
  estimate.planes.clear();
  const OverlayResult result = drift();
  EXPECT_EQ(result.planes, 0);
  EXPECT_EQ(result.aligned.drift_px.count, 0);
  EXPECT_NE(format_table(result).find("no plane"), std::string::npos);
  EXPECT_DOUBLE_EQ(evaluate().scores[0].precision, 0.0);
}

}  // namespace
}  // namespace planecast::engine
