#include "slam/data/map_archive.h"

#include <Eigen/LU>
#include <cmath>
#include <optional>

namespace planecast::slam {
namespace {

/// Least sizes in bytes, by which counts are bounded.
constexpr std::size_t kKeypointBytes = 36;
constexpr std::size_t kPairBytes = 8;
/// Ids are dense, so that a store is as long as its highest id: half a gigabyte of places for each
/// kind, which is over a million landmarks. A file that claims more lies.
constexpr std::size_t kMostStoreBytes = std::size_t{1} << 29;

template <typename Derived>
void put_matrix(const Eigen::MatrixBase<Derived>& matrix, ByteWriter& out) {
  for (Eigen::Index c = 0; c < matrix.cols(); ++c) {
    for (Eigen::Index r = 0; r < matrix.rows(); ++r) out.put(matrix(r, c));
  }
}

template <typename Derived>
void take_matrix(ByteReader& in, Eigen::MatrixBase<Derived>& matrix) {
  for (Eigen::Index c = 0; c < matrix.cols(); ++c) {
    for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
      matrix(r, c) = in.number<typename Derived::Scalar>();
    }
  }
  if (!matrix.allFinite()) in.fail();
}

void put_pose(const Pose& pose, ByteWriter& out) {
  put_matrix(pose.linear(), out);
  put_matrix(pose.translation(), out);
}

Pose take_pose(ByteReader& in) {
  constexpr double kOrthogonal = 1e-6;
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
  take_matrix(in, rotation);
  take_matrix(in, translation);
  const double skew = (rotation.transpose() * rotation - Eigen::Matrix3d::Identity()).norm();
  if (!(skew < kOrthogonal) || rotation.determinant() < 0.0) in.fail();
  Pose pose = Pose::Identity();
  pose.linear() = rotation;
  pose.translation() = translation;
  return pose;
}

double take_finite(ByteReader& in) {
  const auto value = in.number<double>();
  if (!std::isfinite(value)) in.fail();
  return value;
}

void put_ints(const std::vector<int>& values, ByteWriter& out) {
  out.put(static_cast<std::uint64_t>(values.size()));
  for (const int value : values) out.put(static_cast<std::int32_t>(value));
}

std::vector<int> take_ints(ByteReader& in) {
  std::vector<int> values(in.count(sizeof(std::int32_t)));
  for (int& value : values) value = in.number<std::int32_t>();
  return values;
}

void put_pairs(const std::vector<std::pair<int, int>>& pairs, ByteWriter& out) {
  out.put(static_cast<std::uint64_t>(pairs.size()));
  for (const auto& [a, b] : pairs) {
    out.put(static_cast<std::int32_t>(a));
    out.put(static_cast<std::int32_t>(b));
  }
}

std::vector<std::pair<int, int>> take_pairs(ByteReader& in) {
  std::vector<std::pair<int, int>> pairs(in.count(kPairBytes));
  for (auto& [a, b] : pairs) {
    a = in.number<std::int32_t>();
    b = in.number<std::int32_t>();
  }
  return pairs;
}

void put_features(const Features& features, ByteWriter& out) {
  out.put(static_cast<std::uint64_t>(features.keypoints.size()));
  for (const Keypoint& keypoint : features.keypoints) {
    put_matrix(keypoint.raw, out);
    put_matrix(keypoint.pixel, out);
    out.put(keypoint.angle_deg);
    out.put(keypoint.response);
    out.put(static_cast<std::int32_t>(keypoint.octave));
    out.put(keypoint.depth);
    out.put(static_cast<std::int32_t>(keypoint.label));
  }
  for (const Descriptor& descriptor : features.descriptors) {
    for (const std::uint64_t part : descriptor) out.put(part);
  }
}

std::shared_ptr<const Features> take_features(ByteReader& in, const Camera& camera) {
  auto features = std::make_shared<Features>();
  features->keypoints.resize(in.count(kKeypointBytes + sizeof(Descriptor)));
  features->descriptors.resize(features->keypoints.size());
  for (Keypoint& keypoint : features->keypoints) {
    take_matrix(in, keypoint.raw);
    take_matrix(in, keypoint.pixel);
    keypoint.angle_deg = in.number<float>();
    keypoint.response = in.number<float>();
    keypoint.octave = in.number<std::int32_t>();
    keypoint.depth = in.number<float>();
    keypoint.label = in.number<std::int32_t>();
    if (!std::isfinite(keypoint.angle_deg) || !std::isfinite(keypoint.depth)) in.fail();
    // Beyond that, pixels and octaves could overflow an int.
    constexpr float kFarPixel = 1e6F;
    if (keypoint.octave < 0 || keypoint.octave > 63) in.fail();
    if (keypoint.pixel.cwiseAbs().maxCoeff() > kFarPixel ||
        keypoint.raw.cwiseAbs().maxCoeff() > kFarPixel) {
      in.fail();
    }
  }
  for (Descriptor& descriptor : features->descriptors) {
    for (std::uint64_t& part : descriptor) part = in.number<std::uint64_t>();
  }
  if (in.ok()) features->build_grid(camera.width, camera.height);
  return features;
}

template <typename T, typename Put>
void put_store(const SlotStore<T>& store, const Put& put, ByteWriter& out) {
  out.put(static_cast<std::int32_t>(store.next_id()));
  out.put(static_cast<std::uint64_t>(store.size()));
  for (const T& value : store) put(value);
}

/// Ids ascend below next_id.
template <typename T, typename Take>
void take_store(ByteReader& in, SlotStore<T>& store, const Take& take) {
  const auto next_id = in.number<std::int32_t>();
  constexpr auto kMostIds = static_cast<std::int32_t>(kMostStoreBytes / sizeof(std::optional<T>));
  if (next_id < 0 || next_id > kMostIds) in.fail();
  const std::size_t count = in.count(sizeof(std::int32_t));
  int previous = -1;
  for (std::size_t i = 0; i < count && in.ok(); ++i) {
    T value = take();
    if (value.id <= previous || value.id >= next_id) in.fail();
    if (!in.ok()) return;
    previous = value.id;
    store.put(std::move(value));
  }
  if (in.ok()) store.reserve_ids(next_id);
}

}  // namespace

void MapArchive::put(const Keyframe& keyframe, ByteWriter& out) {
  out.put(static_cast<std::int32_t>(keyframe.id));
  out.put(static_cast<std::int32_t>(keyframe.frame_index));
  out.put(keyframe.timestamp);
  put_pose(keyframe.cam_from_world, out);
  out.put(static_cast<std::int32_t>(keyframe.parent));
  out.put(keyframe.unit);
  put_features(*keyframe.features, out);
  put_ints(keyframe.landmarks, out);
  put_ints(keyframe.labels, out);
}

Keyframe MapArchive::take_keyframe(ByteReader& in, const Camera& camera) {
  Keyframe keyframe;
  keyframe.id = in.number<std::int32_t>();
  keyframe.frame_index = in.number<std::int32_t>();
  keyframe.timestamp = take_finite(in);
  keyframe.cam_from_world = take_pose(in);
  keyframe.parent = in.number<std::int32_t>();
  keyframe.unit = take_finite(in);
  keyframe.features = take_features(in, camera);
  keyframe.landmarks = take_ints(in);
  keyframe.labels = take_ints(in);
  return keyframe;
}

void MapArchive::put(const Landmark& landmark, ByteWriter& out) {
  out.put(static_cast<std::int32_t>(landmark.id));
  put_matrix(landmark.position, out);
  put_matrix(landmark.view_from, out);
  for (const std::uint64_t part : landmark.descriptor) out.put(part);
  out.put(landmark.min_distance);
  out.put(landmark.max_distance);
  out.put(static_cast<std::uint64_t>(landmark.observations.size()));
  for (const Observation& observation : landmark.observations) {
    out.put(static_cast<std::int32_t>(observation.keyframe));
    out.put(static_cast<std::int32_t>(observation.keypoint));
  }
  out.put(static_cast<std::int32_t>(landmark.first_keyframe));
  out.put(static_cast<std::int32_t>(landmark.visible));
  out.put(static_cast<std::int32_t>(landmark.found));
  out.put(static_cast<std::int32_t>(landmark.plane));
  put_matrix(landmark.color, out);
}

Landmark MapArchive::take_landmark(ByteReader& in) {
  Landmark landmark;
  landmark.id = in.number<std::int32_t>();
  take_matrix(in, landmark.position);
  take_matrix(in, landmark.view_from);
  for (std::uint64_t& part : landmark.descriptor) part = in.number<std::uint64_t>();
  landmark.min_distance = take_finite(in);
  landmark.max_distance = take_finite(in);
  landmark.observations.resize(in.count(kPairBytes));
  for (Observation& observation : landmark.observations) {
    observation.keyframe = in.number<std::int32_t>();
    observation.keypoint = in.number<std::int32_t>();
  }
  landmark.first_keyframe = in.number<std::int32_t>();
  landmark.visible = in.number<std::int32_t>();
  landmark.found = in.number<std::int32_t>();
  landmark.plane = in.number<std::int32_t>();
  take_matrix(in, landmark.color);
  return landmark;
}

void MapArchive::put(const Plane& plane, ByteWriter& out) {
  out.put(static_cast<std::int32_t>(plane.id));
  put_matrix(plane.normal, out);
  out.put(plane.offset);
  put_matrix(plane.origin, out);
  put_matrix(plane.x_axis, out);
  out.put(static_cast<std::uint8_t>(plane.weak));
  out.put(plane.rms);
  for (const int value : {plane.inliers, plane.first_frame, plane.label, plane.age_keyframes,
                          plane.doubts, plane.stalled_keyframes}) {
    out.put(static_cast<std::int32_t>(value));
  }
  put_ints(plane.observers, out);
  put_ints(plane.merged_from, out);
  out.put(static_cast<std::uint64_t>(plane.depth_points.size()));
  for (std::size_t i = 0; i < plane.depth_points.size(); ++i) {
    put_matrix(plane.depth_points[i], out);
    out.put(static_cast<std::int32_t>(plane.depth_anchors[i].keyframe));
    put_matrix(plane.depth_anchors[i].point_cam, out);
  }
}

Plane MapArchive::take_plane(ByteReader& in) {
  Plane plane;
  plane.id = in.number<std::int32_t>();
  take_matrix(in, plane.normal);
  plane.offset = take_finite(in);
  take_matrix(in, plane.origin);
  take_matrix(in, plane.x_axis);
  plane.weak = in.number<std::uint8_t>() != 0;
  plane.rms = take_finite(in);
  for (int* value : {&plane.inliers, &plane.first_frame, &plane.label, &plane.age_keyframes,
                     &plane.doubts, &plane.stalled_keyframes}) {
    *value = in.number<std::int32_t>();
  }
  plane.observers = take_ints(in);
  plane.merged_from = take_ints(in);
  plane.depth_points.resize(in.count(3 * sizeof(double) + sizeof(std::int32_t)));
  plane.depth_anchors.resize(plane.depth_points.size());
  for (std::size_t i = 0; i < plane.depth_points.size(); ++i) {
    take_matrix(in, plane.depth_points[i]);
    plane.depth_anchors[i].keyframe = in.number<std::int32_t>();
    take_matrix(in, plane.depth_anchors[i].point_cam);
  }
  return plane;
}

void MapArchive::put_history(const Map& map, ByteWriter& out) {
  put_pairs(map.loop_edges, out);
  put_pairs(map.replaced_, out);
  out.put(static_cast<std::uint64_t>(map.erased_keyframes_.size()));
  for (const Map::ErasedKeyframe& erased : map.erased_keyframes_) {
    out.put(static_cast<std::int32_t>(erased.id));
    out.put(static_cast<std::int32_t>(erased.parent));
    put_pose(erased.cam_from_parent, out);
    out.put(erased.unit_per_parent);
  }
}

void MapArchive::take_history(ByteReader& in, Map& map) {
  map.loop_edges = take_pairs(in);
  map.replaced_ = take_pairs(in);
  map.erased_keyframes_.resize(in.count(kPairBytes));
  for (Map::ErasedKeyframe& erased : map.erased_keyframes_) {
    erased.id = in.number<std::int32_t>();
    erased.parent = in.number<std::int32_t>();
    erased.cam_from_parent = take_pose(in);
    erased.unit_per_parent = take_finite(in);
  }
}

std::string MapArchive::encode(const Map& map) {
  ByteWriter out;
  put_store(
      map.keyframes, [&](const Keyframe& value) { put(value, out); }, out);
  put_store(
      map.landmarks, [&](const Landmark& value) { put(value, out); }, out);
  put_store(
      map.planes, [&](const Plane& value) { put(value, out); }, out);
  put_history(map, out);
  return out.bytes();
}

std::optional<Map> MapArchive::decode(std::string_view bytes, const Camera& camera) {
  ByteReader in(bytes);
  Map map;
  take_store(in, map.keyframes, [&] { return take_keyframe(in, camera); });
  take_store(in, map.landmarks, [&] { return take_landmark(in); });
  take_store(in, map.planes, [&] { return take_plane(in); });
  take_history(in, map);
  if (!in.ok() || !in.at_end() || !is_sound(map)) return std::nullopt;
  return map;
}

}  // namespace planecast::slam
