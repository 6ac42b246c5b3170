#pragma once

#include <memory>
#include <vector>

#include "slam/data/map.h"
#include "test/unit/slam/synthetic_views.h"

/// Maps with known truth: keyframes that look at boxes of points.
namespace planecast::slam::synthetic {

struct MapTruth {
  std::vector<Pose> cam_from_world;
  std::vector<Eigen::Vector3d> points;
};

struct MapOptions {
  int keyframes = 6;
  int points = 200;
  double noise_px = 0.0;
  double outlier_share = 0.0;
  bool depth = false;
  double step = 0.25;  ///< between neighbouring keyframes
};

struct MapScene {
  Camera camera = synthetic::camera();
  Map map;
  MapTruth truth;
  int outliers = 0;
};

/// The camera of keyframe k: to and fro sideways and a little forward, looking at the box.
inline Pose path_pose(int k, double step) {
  return k == 0
             ? Pose::Identity()
             : pose_at({step * k, 0.1 * std::sin(1.3 * k), 0.06 * k},
                       {0.02 * std::sin(2.1 * k), -0.05 * std::sin(0.7 * k), 0.03 * std::cos(k)});
}

/// A map at the truth, seen with noise. Keypoint i of a keyframe is its i-th visible point.
inline MapScene make_map(const std::vector<Eigen::Vector3d>& points, const MapOptions& options,
                         Random& random) {
  MapScene scene;
  scene.truth.points = points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    Landmark landmark;
    landmark.id = static_cast<LandmarkId>(i);
    landmark.position = points[i];
    scene.map.landmarks.put(landmark);
  }
  for (int k = 0; k < options.keyframes; ++k) {
    const Pose pose = path_pose(k, options.step);
    scene.truth.cam_from_world.push_back(pose);
    auto features = std::make_shared<Features>();
    std::vector<LandmarkId> seen;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector3d in_camera = pose * points[i];
      if (in_camera.z() < 0.2) continue;
      const Eigen::Vector2d exact = scene.camera.project(in_camera);
      if (!scene.camera.contains(exact)) continue;
      Keypoint keypoint;
      keypoint.raw.setZero();
      keypoint.octave = random.below(3);
      Eigen::Vector2d pixel =
          noisy(exact, options.noise_px * std::pow(1.2, keypoint.octave), random);
      if (random.uniform() < options.outlier_share) {
        pixel = random_pixel(scene.camera, random);
        ++scene.outliers;
      }
      keypoint.pixel = pixel.cast<float>();
      keypoint.raw = keypoint.pixel;
      if (options.depth) keypoint.depth = static_cast<float>(in_camera.z());
      features->keypoints.push_back(keypoint);
      features->descriptors.push_back({});
      seen.push_back(static_cast<LandmarkId>(i));
    }
    Keyframe keyframe;
    keyframe.id = k;
    keyframe.frame_index = k;
    keyframe.cam_from_world = pose;
    keyframe.features = features;
    keyframe.landmarks.assign(seen.size(), kNone);
    keyframe.labels.assign(seen.size(), 0);
    keyframe.parent = k == 0 ? kNone : k - 1;
    scene.map.keyframes.put(keyframe);
    for (std::size_t i = 0; i < seen.size(); ++i) {
      scene.map.add_observation(seen[i], k, static_cast<int>(i));
    }
  }
  // As in a real map, where a landmark has two observers.
  for (LandmarkId id = 0; id < scene.map.landmarks.next_id(); ++id) {
    if (scene.map.landmarks.at(id).observations.size() < 2) scene.map.erase_landmark(id);
  }
  return scene;
}

inline MapScene make_box_map(const MapOptions& options, Random& random) {
  return make_map(box_points(options.points, random), options, random);
}

/// Moves all poses but the first `held` and all points away from the truth.
inline void perturb(Map& map, int held, double rotation, double translation, double position,
                    Random& random) {
  for (Keyframe& keyframe : map.keyframes) {
    if (keyframe.id < held) continue;
    const Pose nudge = pose_at(translation * gaussian3(random), rotation * gaussian3(random));
    keyframe.cam_from_world = nudge * keyframe.cam_from_world;
  }
  for (Landmark& landmark : map.landmarks) landmark.position += position * gaussian3(random);
}

/// How many poses and landmarks are not the same to the bit in both maps.
inline int different_bits(const Map& a, const Map& b) {
  int different = static_cast<int>(a.landmarks.size() != b.landmarks.size());
  for (const Keyframe& keyframe : a.keyframes) {
    const Keyframe* other = b.keyframes.find(keyframe.id);
    different +=
        other == nullptr || keyframe.cam_from_world.matrix() != other->cam_from_world.matrix();
  }
  for (const Landmark& landmark : a.landmarks) {
    const Landmark* other = b.landmarks.find(landmark.id);
    different += other == nullptr || landmark.position != other->position;
  }
  return different;
}

}  // namespace planecast::slam::synthetic
