#pragma once

#include <vector>

#include "slam/data/frame.h"
#include "slam/data/types.h"

namespace planecast::slam {

/// That keypoint `keypoint` of keyframe `keyframe` sees the landmark.
struct Observation {
  KeyframeId keyframe = kNone;
  int keypoint = kNone;
};

struct Landmark {
  LandmarkId id = kNone;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< world
  Eigen::Vector3d view_from =
      Eigen::Vector3d::Zero();  ///< unit, from the landmark towards the mean camera
  Descriptor descriptor = {};   ///< the observers' medoid
  double min_distance = 0.0;    ///< range of distances at which the pyramid covers it
  double max_distance = 0.0;
  std::vector<Observation> observations;  ///< ascending by keyframe
  KeyframeId first_keyframe = kNone;
  int visible = 1;  ///< frames that should have seen it
  int found = 1;    ///< frames that did
  PlaneId plane = kNone;
  Eigen::Vector3f color = Eigen::Vector3f::Constant(128.0F);  ///< RGB 0..255 at creation

  double found_ratio() const { return static_cast<double>(found) / visible; }
};

}  // namespace planecast::slam
