// What the depth of one keyframe tells of planes where there are no masks.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <random>
#include <vector>

#include "planes_mapping_tools.h"
#include "planes_world.h"
#include "slam/geometry/depth_noise.h"
#include "slam/segmentation/depth_normal.h"
#include "slam/stages/map_planes.h"

namespace planecast::slam {
namespace {

using Eigen::Vector3d;

/// A parallelogram corner + [0, 1] a + [0, 1] b.
struct Face {
  Vector3d corner, a, b;
};

/// Depth with the sensor's noise of what lies nearest; 0 where there is nothing.
cv::Mat depth_of(const std::vector<Face>& faces, const Pose& cam_from_world,
                 std::mt19937& generator) {
  std::normal_distribution<double> normal;
  const Camera camera = test_camera();
  cv::Mat depth(camera.height, camera.width, CV_32F, cv::Scalar(0.0F));
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Vector3d ray = camera.ray({x, y});
      double nearest = HUGE_VAL;
      for (const Face& face : faces) {
        // corner + s a + t b = z ray, in the camera.
        Eigen::Matrix3d sides;
        sides << cam_from_world.linear() * face.a, cam_from_world.linear() * face.b, -ray;
        const Vector3d at = sides.inverse() * -(cam_from_world * face.corner);
        const bool inside = at.x() >= 0.0 && at.x() <= 1.0 && at.y() >= 0.0 && at.y() <= 1.0;
        if (inside && at.z() > 0.4) nearest = std::min(nearest, at.z());
      }
      if (nearest == HUGE_VAL) continue;
      depth.at<float>(y, x) =
          static_cast<float>(nearest + depth_sigma_m(nearest) * normal(generator));
    }
  }
  return depth;
}

TEST(SurfaceNormal, IsThatOfATiltedWall) {
  auto generator = test_generator();
  const Vector3d along(1.0, 0.0, 0.6);
  const cv::Mat depth =
      depth_of({{Vector3d(-2, -2, 0.8), 4.0 * along, {0, 4, 0}}}, Pose::Identity(), generator);
  const Vector3d truth = Vector3d(0.6, 0.0, -1.0).normalized();
  int known = 0;
  for (int x = 100; x < 540; x += 40) {
    const auto normal = surface_normal(depth, test_camera(), x, 240, 10);
    if (!normal) continue;
    ++known;
    EXPECT_LT(angle_deg(*normal, truth), 8.0) << x;
  }
  EXPECT_GE(known, 10);
}

TEST(SurfaceNormal, IsNotKnownAtAnEdgeNorWithoutDepth) {
  auto generator = test_generator();
  // A thing that ends 30 cm before the wall, in the middle of the image.
  const cv::Mat depth = depth_of({{Vector3d(-2, -2, 1.8), {4, 0, 0}, {0, 4, 0}},
                                  {Vector3d(-2, -2, 1.5), {2, 0, 0}, {0, 4, 0}}},
                                 Pose::Identity(), generator);
  EXPECT_TRUE(surface_normal(depth, test_camera(), 200, 240, 10).has_value());
  EXPECT_FALSE(surface_normal(depth, test_camera(), 320, 240, 10).has_value());
  EXPECT_FALSE(surface_normal(depth, test_camera(), 3, 240, 10).has_value());
  EXPECT_FALSE(
      surface_normal(cv::Mat(480, 640, CV_32F, cv::Scalar(0.0F)), test_camera(), 200, 240, 10)
          .has_value());
}

TEST(PlanesByDepth, AStairHasStepsAndNoSlope) {
  auto generator = test_generator();
  MapBuilder builder(test_camera());
  const Pose cam_from_world = look_at({0, -0.7, 0}, {0, 0.3, 1.8});
  const KeyframeId id = builder.add_keyframe(cam_from_world);
  std::vector<Face> faces;
  // Treads 28 cm deep, risers 17 cm high: 3 eps_d off the slope at most.
  for (int step = 0; step < 4; ++step) {
    const double y = 0.8 - 0.17 * step;
    const double z = 1.2 + 0.28 * step;
    faces.push_back({{-0.8, y, z}, {1.6, 0, 0}, {0, 0, 0.28}});
    faces.push_back({{-0.8, y - 0.17, z + 0.28}, {1.6, 0, 0}, {0, 0.17, 0}});
  }
  for (const Face& face : faces) {
    add_all(builder, strew(generator, 15, face.corner, face.a, face.b, 0.002), {id}, 0);
  }
  Map map = builder.build();
  map.keyframes.at(id).depth = depth_of(faces, cam_from_world, generator);
  PlaneMapper mapper(PlaneMappingOptions(), test_camera(), true);
  map_planes(map, {id, id}, mapper);
  for (const Plane& plane : map.planes) {
    EXPECT_LT(std::min(angle_deg(plane.normal, kUp), angle_deg(plane.normal, -Vector3d::UnitZ())),
              8.0)
        << plane.id << " " << plane.normal.transpose();
  }
  for (int step = 0; step < 3; ++step) {
    EXPECT_EQ(count_matching(map, kUp, {0, 0.8 - 0.17 * step, 1.34 + 0.28 * step}, 0.02), 1)
        << step;
  }
}

}  // namespace
}  // namespace planecast::slam
