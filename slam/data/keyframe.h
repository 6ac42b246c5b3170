#pragma once

#include <memory>
#include <vector>

#include "slam/data/bag_of_words.h"
#include "slam/data/frame.h"
#include "slam/data/types.h"

namespace planecast::slam {

struct Keyframe {
  KeyframeId id = kNone;
  int frame_index = 0;
  double timestamp = 0.0;
  Pose cam_from_world = Pose::Identity();
  std::shared_ptr<const Features> features;     ///< shared between snapshots, never changed
  std::shared_ptr<const ImagePyramid> pyramid;  ///< raw pixels; shared; may be null
  std::vector<LandmarkId> landmarks;            ///< per keypoint; kNone where there is none
  std::vector<int> labels;  ///< per keypoint: plane instance mask label, 0 = none
  cv::Mat depth;            ///< CV_32F metres, raw pixels; only while the keyframe is being mapped
  cv::Mat nearest_depth;    ///< CV_32F metres, the least of each block of raw pixels; may be empty
  cv::Mat label_image;      ///< CV_16U plane instances, raw pixels; only while it is being mapped
  cv::Mat coarse_labels;    ///< CV_16U, every fourth pixel of them, kept; may be empty
  KeyframeId parent = kNone;  ///< spanning tree
  /// What one unit of length measured from this keyframe at its insertion is worth in the map now:
  /// a closed loop gives each part of a monocular map its own new scale.
  double unit = 1.0;
  std::shared_ptr<const BagOfWords> words;  ///< for place recognition; shared, never changed

  Eigen::Vector3d centre_world() const { return cam_from_world.inverse().translation(); }
};

}  // namespace planecast::slam
