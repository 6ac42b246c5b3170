#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "slam/segmentation/depth_normal.h"
#include "slam/segmentation/plane_segmenter.h"
#include "slam/stages/plane_points.h"

namespace planecast::slam {

namespace {

/// [D] Depth samples per image row: enough for a plane of a hundredth of the image to have 17, and
/// for the normals about them to be known where a surface is ten rows high.
constexpr int kSamplesPerRow = 48;

int sample_step(const Keyframe& keyframe) {
  return std::max(1, keyframe.depth.cols / kSamplesPerRow);
}

/// Of the surface about a raw pixel, in the world; zero where it is not known.
Eigen::Vector3d normal_at(const Keyframe& keyframe, const PlaneContext& context,
                          const Eigen::Vector2d& raw) {
  const auto normal = surface_normal(
      keyframe.depth, context.camera, static_cast<int>(std::lround(raw.x())),
      static_cast<int>(std::lround(raw.y())), sample_step(keyframe) / 2, context.metre);
  if (!normal) return Eigen::Vector3d::Zero();
  return keyframe.cam_from_world.linear().transpose() * *normal;
}

/// One row of KeyframePoints.
struct ShownPoint {
  Eigen::Vector3d position, view_from, normal;
  double z = 0.0;  ///< in the keyframe
  LandmarkId landmark = kNone;
  PlaneId plane = kNone;
  int label = 0;
  Eigen::Vector2d pixel;
  Eigen::Vector3f point_cam = Eigen::Vector3f::Zero();
};

void append(const ShownPoint& point, const PlaneContext& context, KeyframePoints& out) {
  out.points.positions.push_back(point.position);
  out.points.view_from.push_back(point.view_from);
  out.points.band.push_back(band_of(context, point.z));
  out.landmark.push_back(point.landmark);
  out.plane.push_back(point.plane);
  out.label.push_back(point.label);
  out.normal.push_back(point.normal);
  out.pixel.emplace_back(point.pixel.x(), point.pixel.y(), 0.0);
  out.point_cam.push_back(point.point_cam);
}

/// Without normal, label and pixel.
ShownPoint shown_point(const Map& map, const Landmark& landmark, double z) {
  ShownPoint point;
  point.position = landmark.position;
  point.view_from = landmark.view_from;
  point.normal.setZero();
  point.z = z;
  point.landmark = landmark.id;
  if (map.planes.contains(landmark.plane)) point.plane = landmark.plane;
  return point;
}

void append_landmarks(const Map& map, const Keyframe& keyframe, const PlaneContext& context,
                      KeyframePoints& out) {
  for (std::size_t k = 0; k < keyframe.landmarks.size(); ++k) {
    const Landmark* landmark = map.landmarks.find(keyframe.landmarks[k]);
    if (landmark == nullptr) continue;
    const double z = (keyframe.cam_from_world * landmark->position).z();
    if (!(z > 0.0)) continue;
    ShownPoint point = shown_point(map, *landmark, z);
    if (k < keyframe.labels.size()) point.label = keyframe.labels[k];
    const Keypoint& keypoint = keyframe.features->keypoints[k];
    point.pixel = keypoint.pixel.cast<double>();
    if (context.rgbd && !keyframe.depth.empty() && (context.stereo || keypoint.depth > 0.0F)) {
      point.normal = normal_at(keyframe, context, keypoint.raw.cast<double>());
    }
    append(point, context, out);
  }
}

void append_depth_sample(const Keyframe& keyframe, const PlaneContext& context, int x, int y,
                         KeyframePoints& out) {
  ShownPoint point;
  point.z = keyframe.depth.at<float>(y, x);
  if (!(point.z > 0.0) || is_too_vague(context, point.z)) return;
  const Eigen::Vector2d raw(x, y);
  point.pixel = context.camera.has_distortion() ? context.camera.undistort(raw) : raw;
  const Eigen::Vector3d point_cam = point.z * context.camera.ray(point.pixel);
  const Pose world_from_cam = keyframe.cam_from_world.inverse();
  point.position = world_from_cam * point_cam;
  point.view_from = world_from_cam.linear() * -point_cam.normalized();
  point.label = label_at(keyframe.label_image, raw.cast<float>());
  point.normal = normal_at(keyframe, context, raw);
  point.point_cam = point_cam.cast<float>();
  append(point, context, out);
}

/// Distance of the samples in each mask: that of all others, or less where the mask is so small or
/// narrow that few would fall into it.
class MaskSteps {
 public:
  MaskSteps(const cv::Mat& labels, int step) : step_(step) {
    constexpr double kLeastSamples = 24.0;
    std::vector<int> looks;
    for (int y = 0; y < labels.rows; y += kFinest) {
      const auto* row = labels.ptr<std::uint16_t>(y);
      for (int x = 0; x < labels.cols; x += kFinest) {
        if (row[x] >= looks.size()) looks.resize(row[x] + 1U, 0);
        ++looks[row[x]];
      }
    }
    for (const int count : looks) {
      const auto fitting = static_cast<int>(std::sqrt(count / kLeastSamples));
      steps_.push_back(std::min(std::max(fitting, 1) * kFinest, step));
    }
    if (!steps_.empty()) steps_.front() = step;
  }

  bool any_finer() const {
    return std::any_of(steps_.begin(), steps_.end(), [this](int own) { return own < step_; });
  }
  bool is_finer(int label) const {
    return static_cast<std::size_t>(label) < steps_.size() && at(label) < step_;
  }
  int at(int label) const { return steps_[static_cast<std::size_t>(label)]; }

  static constexpr int kFinest = 2;

 private:
  int step_;
  std::vector<int> steps_;  ///< by label; finer ones are multiples of kFinest
};

void append_depth_samples(const Keyframe& keyframe, const PlaneContext& context,
                          KeyframePoints& out) {
  if (!context.rgbd || keyframe.depth.empty()) return;
  const int step = sample_step(keyframe);
  const cv::Mat& labels = keyframe.label_image;
  const MaskSteps steps(labels, step);
  for (int y = step / 2; y < keyframe.depth.rows; y += step) {
    for (int x = step / 2; x < keyframe.depth.cols; x += step) {
      if (!labels.empty() && steps.is_finer(labels.at<std::uint16_t>(y, x))) continue;
      append_depth_sample(keyframe, context, x, y, out);
    }
  }
  if (!steps.any_finer()) return;
  for (int y = 0; y < labels.rows; y += MaskSteps::kFinest) {
    for (int x = 0; x < labels.cols; x += MaskSteps::kFinest) {
      const int label = labels.at<std::uint16_t>(y, x);
      if (!steps.is_finer(label) || x % steps.at(label) != 0 || y % steps.at(label) != 0) continue;
      append_depth_sample(keyframe, context, x, y, out);
    }
  }
}

/// Landmarks, in the keyframe's masks if it has any, that it has no keypoint of. Only those that
/// were seen from about here are taken, since others may be hidden.
void append_unseen_landmarks(const Map& map, const Keyframe& keyframe, const PlaneContext& context,
                             KeyframePoints& out) {
  constexpr double kMinViewCosine = 0.95;
  const Eigen::Vector3d centre = keyframe.centre_world();
  std::vector<char> seen(static_cast<std::size_t>(map.landmarks.next_id()), 0);
  for (const LandmarkId id : keyframe.landmarks) {
    if (id != kNone) seen[static_cast<std::size_t>(id)] = 1;
  }
  for (const Landmark& landmark : map.landmarks) {
    if (seen[static_cast<std::size_t>(landmark.id)] != 0) continue;
    const Eigen::Vector3d to_camera = centre - landmark.position;
    if (to_camera.dot(landmark.view_from) < kMinViewCosine * to_camera.norm()) continue;
    const Eigen::Vector3d point_cam = keyframe.cam_from_world * landmark.position;
    if (!(point_cam.z() > 0.0)) continue;
    ShownPoint point = shown_point(map, landmark, point_cam.z());
    point.pixel = context.camera.project(point_cam);
    if (!context.camera.contains(point.pixel)) continue;
    const Eigen::Vector2d raw =
        context.camera.has_distortion() ? context.camera.distort(point.pixel) : point.pixel;
    point.label = label_at(keyframe.label_image, raw.cast<float>());
    if (point.label != 0 || keyframe.label_image.empty()) append(point, context, out);
  }
}

}  // namespace

bool KeyframePoints::may_face(int i, const Eigen::Vector3d& direction) const {
  constexpr double kMinCosine = 0.85;
  return normal[i].isZero() || normal[i].dot(direction) > kMinCosine;
}

KeyframePoints gather_points(const Map& map, KeyframeId id, const PlaneContext& context) {
  KeyframePoints result;
  const Keyframe* keyframe = map.keyframes.find(id);
  if (keyframe == nullptr || keyframe->features == nullptr) return result;
  append_landmarks(map, *keyframe, context, result);
  append_depth_samples(*keyframe, context, result);
  result.observed = result.size();
  result.has_normals = context.rgbd && !keyframe->depth.empty();
  if (!keyframe->label_image.empty() || context.finished) {
    append_unseen_landmarks(map, *keyframe, context, result);
  }
  result.has_masks = !keyframe->label_image.empty() ||
                     std::any_of(keyframe->labels.begin(), keyframe->labels.end(),
                                 [](int label) { return label > 0; });
  constexpr int kImageNeighbours = 16;
  if (!result.has_masks) result.nearest = nearest_points(result.pixel, kImageNeighbours);
  return result;
}

}  // namespace planecast::slam
