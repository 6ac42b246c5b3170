#pragma once

#include <array>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "slam/segmentation/decode_planes.h"
#include "slam/segmentation/plane_segmenter.h"

namespace planecast::slam {

/// What must be known of an ONNX file to use it.
struct NetworkDescription {
  std::string name;  ///< with `version`, for the record
  std::string version;
  enum class Kind {
    kMaps,       ///< one output of PlaneMaps::kChannels
    kInstances,  ///< masks and scores of instances, as of PlaneRecNet
  };
  Kind kind = Kind::kMaps;
  std::string input;                       ///< its name; empty: the only one
  cv::Size size;                           ///< of the input; pictures are resized to it
  bool rgb = true;                         ///< else BGR
  cv::Vec3d mean = {127.5, 127.5, 127.5};  ///< by channel as the network wants them, of 0..255
  cv::Vec3d deviation = {255, 255, 255};   ///< what is divided by
  std::string output;                      ///< maps: its name; empty: the only one
  std::string masks;   ///< instances: N x h x w, probabilities (1 x N x h x w too)
  std::string scores;  ///< instances: N
  double min_score = 0.3;
  double min_mask = 0.5;
  DecodeOptions decode;  ///< maps
};

/// Masks from a network through cv::dnn: the same on any number of threads.
struct LoadedNetwork {
  std::unique_ptr<PlaneSegmenter> segmenter;  ///< null: `error` says why, on one line
  std::string error;
};
LoadedNetwork load_network(const std::vector<unsigned char>& onnx,
                           const NetworkDescription& description);

}  // namespace planecast::slam
