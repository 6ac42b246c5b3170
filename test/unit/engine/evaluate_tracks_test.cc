#include "engine/evaluate/tracks.h"

#include <gtest/gtest.h>

#include "engine/user_error.h"
#include "textured_table.h"

namespace planecast::engine {
namespace {

/// Blots all over the table, and map points on them.
TablePrint blots() {
  TablePrint print;
  print.grey = cv::Mat(900, 1100, CV_8UC1);
  cv::RNG rng(5);
  rng.fill(print.grey, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(print.grey, print.grey, cv::Size(0, 0), 4.0);
  cv::normalize(print.grey, print.grey, 20, 235, cv::NORM_MINMAX);
  print.corner_xz = {-0.55, 1.95};
  return print;
}

Reconstruction world_with_points() {
  Reconstruction world = filmed_table();
  for (double x = -0.5; x < 0.5; x += 0.04) {
    for (double z = 1.1; z < 1.9; z += 0.04) {
      MapPoint point;
      point.position = Eigen::Vector3d(x, 0.5, z);
      point.plane = 1;
      world.points.push_back(point);
    }
  }
  return world;
}

/// The sequence shows what was filmed; `world` may be changed.
struct Tracks : testing::Test {
  const Reconstruction filmed = world_with_points();
  const TablePrint print = blots();
  PictureSequence sequence = film_table(filmed, print);
  Reconstruction world = filmed;
};

TEST_F(Tracks, TruePosesKeepToTheTexture) {
  const TracksResult result = evaluate_tracks(world, sequence);
  EXPECT_EQ(result.plane_id, 1);
  EXPECT_EQ(result.points, 30);
  EXPECT_EQ(result.frames, 29);
  EXPECT_GT(result.compared_share(), 0.9);
  EXPECT_LT(result.error_px.rms, 0.1);  // what alignment of patches can do on such pictures
}

TEST_F(Tracks, MeasureWhatIsWrong) {
  TrackOptions options;
  options.frame = 0;
  // Turned by a milliradian from frame 1 on: 0.5 px at a focal length of 500.
  for (std::size_t i = 1; i < world.frames.size(); ++i) {
    world.frames[i].world_from_cam->rotate(Eigen::AngleAxisd(0.001, Eigen::Vector3d::UnitY()));
  }
  const TracksResult result = evaluate_tracks(world, sequence, options);
  EXPECT_EQ(result.frame, 0);
  EXPECT_NEAR(result.error_px.rms, 0.53, 0.07);  // the rays' slant adds up to a tenth
  EXPECT_GT(result.compared_share(), 0.9);
}

TEST_F(Tracks, LeaveOutWhatTheMapStandsBefore) {
  const TracksResult open = evaluate_tracks(world, sequence);
  // Half of the table's points get one of another plane a third of the way to the first camera.
  const Eigen::Vector3d centre = world.frames.front().world_from_cam->translation();
  const std::vector<MapPoint> table = world.points;
  for (const MapPoint& point : table) {
    if (point.position.x() < 0.0) continue;
    MapPoint before = point;
    before.position += (centre - point.position) / 3.0;
    before.plane = slam::kNone;
    world.points.push_back(before);
  }
  const TracksResult hidden = evaluate_tracks(world, sequence);
  EXPECT_LT(hidden.visible, open.visible);
  EXPECT_GT(hidden.visible, 0);
}

TEST_F(Tracks, APlaneDoesNotHideItself) {
  // So coarse that nearer points of the table lie within the radius.
  TrackOptions options;
  options.hidden_px = 60.0;
  const TracksResult with_points = evaluate_tracks(world, sequence, options);
  options.hidden_px = 0.0;
  EXPECT_EQ(with_points.visible, evaluate_tracks(world, sequence, options).visible);
}

TEST_F(Tracks, SaysWhatIsMissing) {
  TrackOptions options;
  options.frame = 99;
  EXPECT_THROW(evaluate_tracks(world, sequence, options), UserError);
  world.points.clear();
  EXPECT_THROW(evaluate_tracks(world, sequence), UserError);
}

}  // namespace
}  // namespace planecast::engine
