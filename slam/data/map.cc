#include "slam/data/map.h"

#include <algorithm>

namespace planecast::slam {
namespace {

auto find_observation(std::vector<Observation>& observations, KeyframeId keyframe) {
  return std::lower_bound(
      observations.begin(), observations.end(), keyframe,
      [](const Observation& observation, KeyframeId id) { return observation.keyframe < id; });
}

bool sees(const std::vector<Observation>& observations, KeyframeId keyframe) {
  return std::any_of(observations.begin(), observations.end(),
                     [keyframe](const Observation& o) { return o.keyframe == keyframe; });
}

/// Index of the one with the least distance to all the others together; the first of equals.
std::size_t medoid_of(const std::vector<const Descriptor*>& descriptors) {
  const std::size_t n = descriptors.size();
  if (n < 3) return 0;  // each is as far from the other
  std::vector<int> sums(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      const int distance = hamming_distance(*descriptors[i], *descriptors[j]);
      sums[i] += distance;
      sums[j] += distance;
    }
  }
  return static_cast<std::size_t>(std::min_element(sums.begin(), sums.end()) - sums.begin());
}

}  // namespace

void Map::add_observation(LandmarkId landmark, KeyframeId keyframe, int keypoint) {
  std::vector<Observation>& observations = landmarks.at(landmark).observations;
  const auto place = find_observation(observations, keyframe);
  if (place != observations.end() && place->keyframe == keyframe) return;
  observations.insert(place, {keyframe, keypoint});
  keyframes.at(keyframe).landmarks[static_cast<std::size_t>(keypoint)] = landmark;
}

void Map::remove_observation(LandmarkId landmark, KeyframeId keyframe, int min_observations) {
  std::vector<Observation>& observations = landmarks.at(landmark).observations;
  const auto place = find_observation(observations, keyframe);
  if (place == observations.end() || place->keyframe != keyframe) return;
  keyframes.at(keyframe).landmarks[static_cast<std::size_t>(place->keypoint)] = kNone;
  observations.erase(place);
  if (static_cast<int>(observations.size()) < min_observations) erase_landmark(landmark);
}

void Map::erase_landmark(LandmarkId landmark) {
  const Landmark* found = landmarks.find(landmark);
  if (found == nullptr) return;
  for (const Observation& observation : found->observations) {
    keyframes.at(observation.keyframe).landmarks[static_cast<std::size_t>(observation.keypoint)] =
        kNone;
  }
  landmarks.erase(landmark);
}

void Map::erase_keyframe(KeyframeId keyframe) {
  const Keyframe* found = keyframes.find(keyframe);
  if (found == nullptr) return;
  const KeyframeId parent = found->parent;
  const std::vector<LandmarkId> seen = found->landmarks;
  const ErasedKeyframe erased = {keyframe, parent,
                                 relative_to_keyframe(found->cam_from_world, parent),
                                 found->unit / keyframe_unit(parent)};
  erased_keyframes_.insert(
      std::lower_bound(erased_keyframes_.begin(), erased_keyframes_.end(), keyframe,
                       [](const ErasedKeyframe& e, KeyframeId id) { return e.id < id; }),
      erased);
  for (const LandmarkId landmark : seen) {
    if (landmark != kNone) remove_observation(landmark, keyframe);
  }
  for (Keyframe& other : keyframes) {
    if (other.parent == keyframe) other.parent = parent;
  }
  for (auto& [a, b] : loop_edges) {
    if (a == keyframe) a = parent;
    if (b == keyframe) b = parent;
  }
  std::erase_if(loop_edges, [](const auto& e) { return e.first == kNone || e.first == e.second; });
  keyframes.erase(keyframe);
}

const Map::ErasedKeyframe* Map::find_erased(KeyframeId keyframe) const {
  const auto place =
      std::lower_bound(erased_keyframes_.begin(), erased_keyframes_.end(), keyframe,
                       [](const ErasedKeyframe& e, KeyframeId id) { return e.id < id; });
  return place != erased_keyframes_.end() && place->id == keyframe ? &*place : nullptr;
}

Pose Map::keyframe_pose(KeyframeId keyframe) const {
  if (const Keyframe* alive = keyframes.find(keyframe)) return alive->cam_from_world;
  const ErasedKeyframe* erased = find_erased(keyframe);
  return erased == nullptr ? Pose::Identity()
                           : from_keyframe(erased->cam_from_parent, erased->parent);
}

double Map::keyframe_unit(KeyframeId keyframe) const {
  if (const Keyframe* alive = keyframes.find(keyframe)) return alive->unit;
  const ErasedKeyframe* erased = find_erased(keyframe);
  return erased == nullptr ? 1.0 : erased->unit_per_parent * keyframe_unit(erased->parent);
}

Pose Map::relative_to_keyframe(const Pose& cam_from_world, KeyframeId keyframe) const {
  Pose relative = cam_from_world * keyframe_pose(keyframe).inverse();
  relative.translation() /= keyframe_unit(keyframe);
  return relative;
}

Pose Map::from_keyframe(const Pose& cam_from_keyframe, KeyframeId keyframe) const {
  Pose scaled = cam_from_keyframe;
  scaled.translation() *= keyframe_unit(keyframe);
  return scaled * keyframe_pose(keyframe);
}

KeyframeId Map::living_ancestor(KeyframeId keyframe) const {
  if (keyframe == kNone || keyframes.contains(keyframe)) return keyframe;
  const ErasedKeyframe* erased = find_erased(keyframe);
  return erased == nullptr ? kNone : living_ancestor(erased->parent);
}

void Map::replace_landmark(LandmarkId from, LandmarkId to) {
  if (from == to || !landmarks.contains(from) || !landmarks.contains(to)) return;
  const Landmark old = landmarks.at(from);
  erase_landmark(from);
  for (const Observation& observation : old.observations) {
    if (!sees(landmarks.at(to).observations, observation.keyframe)) {
      add_observation(to, observation.keyframe, observation.keypoint);
    }
  }
  Landmark& target = landmarks.at(to);
  target.visible += old.visible;
  target.found += old.found;
  if (target.plane == kNone) target.plane = old.plane;
  replaced_.insert(std::lower_bound(replaced_.begin(), replaced_.end(), std::pair(from, to)),
                   {from, to});
}

LandmarkId Map::resolve(LandmarkId id) const {
  while (!landmarks.contains(id)) {
    const auto place = std::lower_bound(replaced_.begin(), replaced_.end(), std::pair(id, kNone));
    if (place == replaced_.end() || place->first != id) return kNone;
    id = place->second;
  }
  return id;
}

std::vector<std::pair<KeyframeId, int>> Map::covisible(KeyframeId keyframe, int min_shared) const {
  std::vector<int> shared(static_cast<std::size_t>(keyframes.next_id()), 0);
  for (const LandmarkId id : keyframes.at(keyframe).landmarks) {
    if (id == kNone) continue;
    for (const Observation& observation : landmarks.at(id).observations) {
      ++shared[static_cast<std::size_t>(observation.keyframe)];
    }
  }
  std::vector<std::pair<KeyframeId, int>> result;
  for (KeyframeId id = 0; id < keyframes.next_id(); ++id) {
    const int count = shared[static_cast<std::size_t>(id)];
    if (id != keyframe && count >= min_shared) result.emplace_back(id, count);
  }
  std::stable_sort(result.begin(), result.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  return result;
}

void Map::update_landmark_summary(LandmarkId id, const ScaleLevels& levels) {
  Landmark& landmark = landmarks.at(id);
  if (landmark.observations.empty()) return;
  std::vector<const Descriptor*> descriptors;
  descriptors.reserve(landmark.observations.size());
  Eigen::Vector3d view_sum = Eigen::Vector3d::Zero();
  for (const Observation& observation : landmark.observations) {
    const Keyframe& keyframe = keyframes.at(observation.keyframe);
    descriptors.push_back(
        &keyframe.features->descriptors[static_cast<std::size_t>(observation.keypoint)]);
    view_sum += (keyframe.centre_world() - landmark.position).normalized();
  }
  landmark.descriptor = *descriptors[medoid_of(descriptors)];
  if (view_sum.norm() > 1e-9) landmark.view_from = view_sum.normalized();

  const Observation& reference = landmark.observations.front();
  const Keyframe& keyframe = keyframes.at(reference.keyframe);
  const double distance = (keyframe.centre_world() - landmark.position).norm();
  const int octave =
      keyframe.features->keypoints[static_cast<std::size_t>(reference.keypoint)].octave;
  landmark.max_distance = distance * levels.scale(octave);
  landmark.min_distance = landmark.max_distance / levels.scale(levels.levels - 1);
}

std::vector<LandmarkId> Map::landmarks_of(PlaneId plane) const {
  std::vector<LandmarkId> result;
  for (const Landmark& landmark : landmarks) {
    if (landmark.plane == plane) result.push_back(landmark.id);
  }
  return result;
}

std::vector<double> Map::landmark_depths(KeyframeId id) const {
  const Keyframe& keyframe = keyframes.at(id);
  std::vector<double> depths;
  for (const LandmarkId landmark : keyframe.landmarks) {
    if (landmark == kNone) continue;
    depths.push_back((keyframe.cam_from_world * landmarks.at(landmark).position).z());
  }
  return depths;
}

double Map::median_depth(KeyframeId id) const {
  std::vector<double> depths = landmark_depths(id);
  if (depths.empty()) return 0.0;
  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  return *middle;
}

void Map::transform(double scale, const Pose& new_from_old) {
  const auto moved = [&](const Eigen::Vector3d& point) -> Eigen::Vector3d {
    return scale * (new_from_old.linear() * point) + new_from_old.translation();
  };
  for (Keyframe& keyframe : keyframes) {
    const Eigen::Vector3d centre = moved(keyframe.centre_world());
    keyframe.cam_from_world.linear() =
        (keyframe.cam_from_world.linear() * new_from_old.linear().transpose()).eval();
    keyframe.cam_from_world.translation() = -(keyframe.cam_from_world.linear() * centre);
    keyframe.unit *= scale;
  }
  for (Landmark& landmark : landmarks) {
    landmark.position = moved(landmark.position);
    landmark.view_from = new_from_old.linear() * landmark.view_from;
    landmark.min_distance *= scale;
    landmark.max_distance *= scale;
  }
  for (Plane& plane : planes) {
    plane.normal = new_from_old.linear() * plane.normal;
    plane.x_axis = new_from_old.linear() * plane.x_axis;
    plane.origin = moved(plane.origin);
    plane.offset = -plane.normal.dot(plane.origin);
    plane.rms *= scale;
    for (Eigen::Vector3d& point : plane.depth_points) point = moved(point);
  }
}

}  // namespace planecast::slam
