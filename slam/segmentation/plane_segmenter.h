#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "slam/data/camera.h"
#include "slam/data/frame.h"

namespace planecast::slam {

/// Plane instance masks as a noisy sensor: never trusted, always refined by graph-cut RANSAC.
class PlaneSegmenter {
 public:
  virtual ~PlaneSegmenter() = default;
  /// CV_16U, the size of the image, 0 = not planar; an empty image where it cannot say anything.
  virtual cv::Mat segment(const FrameInput& frame) = 0;
  virtual std::string name() const = 0;  ///< with version, for the record
};

/// Masks that came with the frame (FrameInput::labels).
std::unique_ptr<PlaneSegmenter> make_mask_segmenter();
/// Region growing on the normals of FrameInput::depth.
std::unique_ptr<PlaneSegmenter> make_depth_segmenter(const Camera& camera);
/// Says nothing: planes are fitted to the landmarks alone.
std::unique_ptr<PlaneSegmenter> make_no_segmenter();

/// Label of a keypoint: that of its raw pixel where the 3x3 window about it agrees, else 0.
int label_at(const cv::Mat& labels, const Eigen::Vector2f& raw_pixel);

}  // namespace planecast::slam
