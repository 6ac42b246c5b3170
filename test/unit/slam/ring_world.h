#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "slam/data/map.h"
#include "test/unit/slam/synthetic_views.h"

/// A walk around a round room that comes back to its beginning with drift, as a map that has not
/// noticed: what is seen again in the second round has landmarks of its own.
namespace planecast::slam::synthetic {

struct RingOptions {
  int round = 40;  ///< keyframes a round
  int extra = 8;   ///< keyframes of the second round
  int points = 2500;
  double scale_drift = 0.002;     ///< ln of the scale a keyframe
  double turn_drift_rad = 0.001;  ///< a keyframe
  double noise_px = 0.3;
  bool depth = false;
};

struct RingWorld {
  Camera camera = synthetic::camera();
  Map map;
  std::vector<Pose> true_cam_from_world;     ///< by keyframe
  std::vector<Eigen::Vector3d> true_points;  ///< by landmark
};

inline Pose ring_pose(int index, int round) {
  const double a = 2.0 * M_PI * index / round;
  const Eigen::Vector3d ahead(std::cos(a), 0.0, std::sin(a));
  Pose world_from_cam = Pose::Identity();
  world_from_cam.linear().col(0) = Eigen::Vector3d::UnitY().cross(ahead);
  world_from_cam.linear().col(1) = Eigen::Vector3d::UnitY();
  world_from_cam.linear().col(2) = ahead;
  world_from_cam.translation() =
      Eigen::Vector3d(-1.2 * std::sin(a), 0.05 * std::sin(3.0 * a), 1.2 * std::cos(a));
  return world_from_cam.inverse();
}

/// What the map thinks where each camera is: every step turns and scales a little too much.
inline std::vector<Pose> drifted_poses(const std::vector<Pose>& truth, const RingOptions& options,
                                       std::vector<double>& scale) {
  std::vector<Pose> drifted = {truth.front()};
  scale = {1.0};
  for (std::size_t i = 1; i < truth.size(); ++i) {
    Pose step = truth[i] * truth[i - 1].inverse();
    scale.push_back(scale.back() * std::exp(options.scale_drift));
    step.translation() *= scale.back();
    const Pose turn = pose_at(Eigen::Vector3d::Zero(), {0.0, options.turn_drift_rad, 0.0});
    drifted.push_back(turn * step * drifted.back());
  }
  return drifted;
}

/// Adds keyframe `k` with the sights of all points; a point unseen for `round` / 2 keyframes gets a
/// new landmark.
class RingBuilder {
 public:
  RingBuilder(const RingOptions& options, Random& random) : options_(options), random_(random) {
    for (int i = 0; i < options.points; ++i) {
      const double a = 2.0 * M_PI * random.uniform();
      const double radius = 4.0 + 0.8 * random.uniform();
      const double height = 5.0 * random.uniform() - 2.5;
      points_.emplace_back(radius * std::cos(a), height, radius * std::sin(a));
      descriptors_.push_back({random.next(), random.next(), random.next(), random.next()});
    }
    for (int k = 0; k < options.round + options.extra; ++k) {
      world_.true_cam_from_world.push_back(ring_pose(k, options.round));
    }
    drifted_ = drifted_poses(world_.true_cam_from_world, options, scale_);
    landmark_of_.assign(points_.size(), kNone);
    last_seen_.assign(points_.size(), -1);
  }

  void add_keyframe(int k) {
    const auto index = static_cast<std::size_t>(k);
    const Pose& truth = world_.true_cam_from_world[index];
    auto features = std::make_shared<Features>();
    std::vector<std::size_t> seen;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Eigen::Vector3d in_camera = truth * points_[i];
      if (in_camera.z() < 0.3) continue;
      const Eigen::Vector2d exact = world_.camera.project(in_camera);
      if (!world_.camera.contains(exact, 4.0)) continue;
      features->keypoints.push_back(keypoint_of(exact, in_camera, scale_[index]));
      features->descriptors.push_back(with_wrong_bits(descriptors_[i]));
      seen.push_back(i);
    }
    features->build_grid(world_.camera.width, world_.camera.height);
    Keyframe keyframe;
    keyframe.id = k;
    keyframe.frame_index = 10 * k;
    keyframe.cam_from_world = drifted_[index];
    keyframe.features = features;
    keyframe.landmarks.assign(seen.size(), kNone);
    keyframe.labels.assign(seen.size(), 0);
    keyframe.parent = k - 1;
    world_.map.keyframes.put(keyframe);
    for (std::size_t s = 0; s < seen.size(); ++s) see(seen[s], k, static_cast<int>(s));
    for (const std::size_t i : seen) world_.map.update_landmark_summary(landmark_of_[i], {});
  }

  RingWorld& world() { return world_; }

 private:
  Keypoint keypoint_of(const Eigen::Vector2d& exact, const Eigen::Vector3d& in_camera,
                       double scale) {
    Keypoint keypoint;
    const double octave = std::log(6.0 / in_camera.norm()) / std::log(1.2);
    keypoint.octave = std::clamp(static_cast<int>(std::ceil(octave)), 0, 7);
    keypoint.pixel = noisy(exact, options_.noise_px, random_).cast<float>();
    keypoint.raw = keypoint.pixel;
    if (options_.depth) keypoint.depth = static_cast<float>(scale * in_camera.z());
    return keypoint;
  }
  Descriptor with_wrong_bits(Descriptor descriptor) {
    for (int i = 0; i < 10; ++i) {
      const int bit = random_.below(256);
      descriptor[static_cast<std::size_t>(bit / 64)] ^= std::uint64_t{1} << (bit % 64);
    }
    return descriptor;
  }
  void see(std::size_t point, int k, int keypoint) {
    const auto index = static_cast<std::size_t>(k);
    if (last_seen_[point] < 0 || k - last_seen_[point] > options_.round / 2) {
      Landmark landmark;
      landmark.id = world_.map.landmarks.next_id();
      const Eigen::Vector3d in_camera = world_.true_cam_from_world[index] * points_[point];
      landmark.position = drifted_[index].inverse() * (scale_[index] * in_camera);
      landmark.first_keyframe = k;
      world_.map.landmarks.put(landmark);
      world_.true_points.push_back(points_[point]);
      landmark_of_[point] = landmark.id;
    }
    last_seen_[point] = k;
    world_.map.add_observation(landmark_of_[point], k, keypoint);
  }

  RingOptions options_;
  Random& random_;
  RingWorld world_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<Descriptor> descriptors_;
  std::vector<Pose> drifted_;
  std::vector<double> scale_;
  std::vector<LandmarkId> landmark_of_;
  std::vector<int> last_seen_;
};

}  // namespace planecast::slam::synthetic
