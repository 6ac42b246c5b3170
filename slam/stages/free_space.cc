#include "slam/stages/free_space.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "slam/geometry/lens.h"

namespace planecast::slam {
namespace {

int block_side(int image_width, const FreeSpaceOptions& options) {
  return std::max(2, static_cast<int>(std::lround(options.block_px * image_width / 640.0)));
}

/// The least depth of the block at a raw pixel and of those around it; 0 where one of them has
/// none.
double least_about(const cv::Mat& nearest, const Eigen::Vector2d& raw, int side) {
  const int col = static_cast<int>(std::floor((raw.x() + 0.5) / side));
  const int row = static_cast<int>(std::floor((raw.y() + 0.5) / side));
  if (col < 1 || row < 1 || col + 1 >= nearest.cols || row + 1 >= nearest.rows) return 0.0;
  float least = nearest.at<float>(row, col);
  for (int y = row - 1; y <= row + 1; ++y) {
    const float* depths = nearest.ptr<float>(y);
    least = std::min({least, depths[col - 1], depths[col], depths[col + 1]});
  }
  return static_cast<double>(least);
}

enum Emptiness : uchar { kNotKnown, kLikely, kCertain };

bool exceeds(double seen, double z, const DepthMargin& margin) {
  return seen > z * (1.0 + margin.relative) + margin.metres;
}

/// Whether the place of a point was empty when the keyframe looked.
Emptiness was_empty(const Keyframe& keyframe, const Eigen::Vector3d& point_world,
                    const Camera& camera, int side, const FreeSpaceOptions& options) {
  if (keyframe.nearest_depth.empty()) return kNotKnown;
  const Eigen::Vector3d point = keyframe.cam_from_world * point_world;
  if (!(point.z() > 0.0)) return kNotKnown;
  const double seen = least_about(keyframe.nearest_depth, project_raw(camera, point), side);
  if (exceeds(seen, point.z(), options.certain)) return kCertain;
  return exceeds(seen, point.z(), options.likely) ? kLikely : kNotKnown;
}

/// Leaves of the likely blocks those that hang together with a certain one.
cv::Mat connected_to_certain(const cv::Mat& emptiness) {
  cv::Mat labels;
  const int count = cv::connectedComponents(emptiness, labels, 8, CV_32S);
  std::vector<uchar> moves(static_cast<std::size_t>(count), 0);
  for (int row = 0; row < labels.rows; ++row) {
    for (int col = 0; col < labels.cols; ++col) {
      if (emptiness.at<uchar>(row, col) != kCertain) continue;
      moves[static_cast<std::size_t>(labels.at<int>(row, col))] = 255;
    }
  }
  cv::Mat moving(labels.size(), CV_8U);
  for (int row = 0; row < labels.rows; ++row) {
    for (int col = 0; col < labels.cols; ++col) {
      moving.at<uchar>(row, col) = moves[static_cast<std::size_t>(labels.at<int>(row, col))];
    }
  }
  return moving;
}

}  // namespace

cv::Mat nearest_depths(const cv::Mat& depth, const FreeSpaceOptions& options) {
  const int side = block_side(depth.cols, options);
  cv::Mat nearest(depth.rows / side, depth.cols / side, CV_32F, cv::Scalar(0.0));
  for (int y = 0; y < nearest.rows * side; ++y) {
    const float* from = depth.ptr<float>(y);
    float* to = nearest.ptr<float>(y / side);
    for (int x = 0; x < nearest.cols * side; ++x) {
      float& least = to[x / side];
      if (from[x] > 0.0F && (least == 0.0F || from[x] < least)) least = from[x];
    }
  }
  return nearest;
}

cv::Mat moving_parts(const cv::Mat& depth, const Pose& cam_from_world, const Map& map,
                     const std::vector<KeyframeId>& keyframes, const Camera& camera,
                     const FreeSpaceOptions& options) {
  const int side = block_side(depth.cols, options);
  const cv::Mat nearest = nearest_depths(depth, options);
  const Pose world_from_cam = cam_from_world.inverse();
  cv::Mat emptiness(nearest.size(), CV_8U, cv::Scalar(kNotKnown));
  bool any = false;
  for (int row = 0; row < nearest.rows; ++row) {
    for (int col = 0; col < nearest.cols; ++col) {
      const auto z = static_cast<double>(nearest.at<float>(row, col));
      if (z <= 0.0) continue;
      const Eigen::Vector2d middle(side * (col + 0.5) - 0.5, side * (row + 0.5) - 0.5);
      const Eigen::Vector3d point_world =
          world_from_cam * (camera.ray(camera.undistort(middle)) * z);
      Emptiness most = kNotKnown;
      for (const KeyframeId id : keyframes) {
        if (most == kCertain) break;
        most = std::max(most, was_empty(map.keyframes.at(id), point_world, camera, side, options));
      }
      emptiness.at<uchar>(row, col) = most;
      any = any || most == kCertain;
    }
  }
  if (!any) return {};
  const cv::Mat blocks = connected_to_certain(emptiness);
  cv::Mat moving(depth.size(), CV_8U, cv::Scalar(0));
  for (int row = 0; row < blocks.rows; ++row) {
    for (int col = 0; col < blocks.cols; ++col) {
      if (blocks.at<uchar>(row, col) == 0) continue;
      moving(cv::Rect(col * side, row * side, side, side)).setTo(255);
    }
  }
  return moving;
}

}  // namespace planecast::slam
