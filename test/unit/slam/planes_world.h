#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "slam/data/camera.h"
#include "slam/data/map.h"

namespace planecast::slam {

/// A generator seeded by the running test's name, so that the order of tests does not matter.
inline std::mt19937 test_generator() {
  const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
  std::uint32_t seed = 2166136261U;
  for (const char c : std::string(info->test_suite_name()) + info->name()) {
    seed = (seed ^ static_cast<unsigned char>(c)) * 16777619U;
  }
  return std::mt19937(seed);
}

inline Camera test_camera() {
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = 525.0;
  camera.fy = 525.0;
  camera.cx = 319.5;
  camera.cy = 239.5;
  return camera;
}

/// A camera at `centre` that looks at `target` with the world's y axis down.
inline Pose look_at(const Eigen::Vector3d& centre, const Eigen::Vector3d& target) {
  const Eigen::Vector3d z = (target - centre).normalized();
  const Eigen::Vector3d x = Eigen::Vector3d::UnitY().cross(z).normalized();
  Pose world_from_cam = Pose::Identity();
  world_from_cam.linear().col(0) = x;
  world_from_cam.linear().col(1) = z.cross(x);
  world_from_cam.linear().col(2) = z;
  world_from_cam.translation() = centre;
  return world_from_cam.inverse();
}

/// Builds a map by hand: keyframes first, then landmarks with exact pixels in the keyframes given
/// that see them, then build(). The world's y axis points down, as in a first camera held level.
class MapBuilder {
 public:
  explicit MapBuilder(const Camera& camera) : camera_(camera) {}

  KeyframeId add_keyframe(const Pose& cam_from_world) {
    const auto id = static_cast<KeyframeId>(poses_.size());
    poses_.push_back(cam_from_world);
    keypoints_.emplace_back();
    labels_.emplace_back();
    return id;
  }

  /// Landmark at `estimated`, whose keypoints are where `seen_at` projects; `label` in every image.
  LandmarkId add_landmark(const Eigen::Vector3d& estimated, const Eigen::Vector3d& seen_at,
                          const std::vector<KeyframeId>& observers, int label) {
    Landmark landmark;
    landmark.id = static_cast<LandmarkId>(landmarks_.size());
    landmark.position = estimated;
    for (const KeyframeId keyframe : observers) {
      const Eigen::Vector3d point_cam = poses_[keyframe] * seen_at;
      if (point_cam.z() < 0.1 || !camera_.contains(camera_.project(point_cam))) continue;
      Keypoint keypoint;
      keypoint.pixel = camera_.project(point_cam).cast<float>();
      keypoint.raw = keypoint.pixel;
      landmark.observations.push_back({keyframe, static_cast<int>(keypoints_[keyframe].size())});
      landmark.view_from += (poses_[keyframe].inverse().translation() - estimated).normalized();
      keypoints_[keyframe].push_back(keypoint);
      labels_[keyframe].push_back(label);
    }
    if (landmark.observations.empty()) return kNone;
    landmark.view_from.normalize();
    landmarks_.push_back(std::move(landmark));
    return landmarks_.back().id;
  }
  LandmarkId add_landmark(const Eigen::Vector3d& position, const std::vector<KeyframeId>& observers,
                          int label) {
    return add_landmark(position, position, observers, label);
  }

  Map build() const {
    Map map;
    for (std::size_t k = 0; k < poses_.size(); ++k) {
      Keyframe keyframe;
      keyframe.id = static_cast<KeyframeId>(k);
      keyframe.frame_index = static_cast<int>(10 * k);
      keyframe.cam_from_world = poses_[k];
      auto features = std::make_shared<Features>();
      features->keypoints = keypoints_[k];
      features->descriptors.resize(keypoints_[k].size());
      keyframe.features = features;
      keyframe.landmarks.assign(keypoints_[k].size(), kNone);
      keyframe.labels = labels_[k];
      map.keyframes.put(keyframe);
    }
    for (const Landmark& landmark : landmarks_) {
      Landmark bare = landmark;
      bare.observations.clear();
      map.landmarks.put(bare);
      for (const Observation& o : landmark.observations) {
        map.add_observation(landmark.id, o.keyframe, o.keypoint);
      }
    }
    return map;
  }

 private:
  Camera camera_;
  std::vector<Pose> poses_;
  std::vector<std::vector<Keypoint>> keypoints_;
  std::vector<std::vector<int>> labels_;
  std::vector<Landmark> landmarks_;
};

/// `count` points strewn evenly over the parallelogram corner + a s + b t, with normal noise
/// `sigma`.
inline std::vector<Eigen::Vector3d> strew(std::mt19937& generator, int count,
                                          const Eigen::Vector3d& corner, const Eigen::Vector3d& a,
                                          const Eigen::Vector3d& b, double sigma) {
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::normal_distribution<double> normal(0.0, 1.0);
  const Eigen::Vector3d n = a.cross(b).normalized();
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i) {
    const double s = uniform(generator);
    const double t = uniform(generator);
    points.push_back(corner + s * a + t * b + sigma * normal(generator) * n);
  }
  return points;
}

}  // namespace planecast::slam
