#include "engine/scene/markers.h"

#include <gtest/gtest.h>

#include <opencv2/aruco.hpp>

#include "engine/marker_dictionary.h"
#include "textured_table.h"

namespace planecast::engine {
namespace {

/// Marker 7 of 5x5_100 on a white sheet on the table: black square of 0.16 m, its centre at
/// x = 0.1, z = 1.5, right way up for the viewer.
TablePrint marker_print() {
  TablePrint print;
  print.grey = cv::Mat(240, 240, CV_8UC1, cv::Scalar(255));
  cv::Mat marker;
  cv::aruco::drawMarker(cv::aruco::getPredefinedDictionary(cv::aruco::DICT_5X5_100), 7, 160,
                        marker);
  marker.copyTo(print.grey(cv::Rect(40, 40, 160, 160)));
  print.corner_xz = {0.1 - 0.1195, 1.5 + 0.1195};
  return print;
}

constexpr double kSide = 0.16;

TEST(Markers, AreFoundOnTheirPlane) {
  const Reconstruction world = filmed_table();
  const TablePrint print = marker_print();
  PictureSequence sequence = film_table(world, print);
  const MarkerMap found = find_markers(sequence, world, {{"5x5_100", 7}, {"5x5_100", 8}});
  ASSERT_EQ(found.size(), 1U);
  const FoundMarker& marker = found.begin()->second;
  EXPECT_EQ(marker.plane_id, 1);
  EXPECT_GT(marker.views, 20);
  // A corner is found to a tenth of a pixel of 2.2 mm; the mean of the views does no worse.
  EXPECT_LT((marker.centre() - Eigen::Vector3d(0.1, 0.5, 1.5)).norm(), 0.001);
  EXPECT_NEAR(marker.side(), kSide, 0.01 * kSide);
  EXPECT_GT(marker.x_axis().x(), 0.999);
  EXPECT_LT(marker.normal().y(), -0.999);
}

TEST(Markers, WithoutAPlaneTheRaysMeet) {
  Reconstruction world = filmed_table();
  const TablePrint print = marker_print();
  PictureSequence sequence = film_table(world, print);
  world.planes.clear();
  const MarkerMap found = find_markers(sequence, world, {{"5x5_100", 7}});
  ASSERT_EQ(found.size(), 1U);
  const FoundMarker& marker = found.begin()->second;
  EXPECT_EQ(marker.plane_id, slam::kNone);
  EXPECT_LT((marker.centre() - Eigen::Vector3d(0.1, 0.5, 1.5)).norm(), 0.005);
  EXPECT_NEAR(marker.side(), kSide, 0.02 * kSide);
  // From one place they do not.
  for (FrameRecord& frame : world.frames) frame.world_from_cam = world.frames[0].world_from_cam;
  EXPECT_TRUE(find_markers(sequence, world, {{"5x5_100", 7}}).empty());
}

TEST(Markers, DictionariesAreKnownByName) {
  EXPECT_EQ(marker_dictionary("4x4_50")->bytesList.rows, 50);
  EXPECT_EQ(marker_dictionary("apriltag_36h11")->bytesList.rows, 587);
  EXPECT_EQ(marker_dictionary("8x8"), nullptr);
}

}  // namespace
}  // namespace planecast::engine
