#pragma once

#include <memory>
#include <opencv2/core.hpp>

#include "slam/data/camera.h"
#include "slam/data/frame.h"
#include "slam/features/orb.h"

namespace planecast::slam {

struct PrepareOptions {
  OrbOptions orb;
  bool rgbd = false;
  double max_keypoint_depth_m = 8.0;  ///< depth beyond it is not used
};

/// One image as the stages hold it. The features may be missing: the patch front end does without
/// them on most frames.
struct ImageFeatures {
  int frame_index = 0;
  double timestamp = 0.0;
  std::shared_ptr<const Features> features;
  std::shared_ptr<const ImagePyramid> pyramid;  ///< grey
  cv::Mat grey_or_bgr;
  cv::Mat depth;  ///< RGB-D only
  cv::Mat labels;
  cv::Mat moving;           ///< CV_8U, raw pixels, not 0 on what moves; empty where nothing does
  double prepare_ms = 0.0;  ///< counts as tracking; for the record only

  bool moves_at(const Eigen::Vector2f& raw) const;
};

/// Depth at a raw pixel; 0 where there is none, where it is beyond `max_depth_m` and where the 3x3
/// window disagrees, as at the edge of an object.
float depth_at(const cv::Mat& depth, const Eigen::Vector2f& raw, double max_depth_m);

/// Makes images ready for the stages. Each thread needs one of its own.
class ImagePreparer {
 public:
  ImagePreparer(const PrepareOptions& options, const Camera& camera);

  /// Grey pyramid, no features.
  ImageFeatures read(const FrameInput& frame) const;
  /// ORB features with depth; `limit` as in OrbExtractor::extract.
  void extract(ImageFeatures& image, int limit = 0);
  /// Corners on what does not move, not described yet, for more to be added by
  /// OrbExtractor::append.
  Features detect(const ImageFeatures& image, int limit = 0);
  void add_depth(const ImageFeatures& image, Features& features) const;
  OrbExtractor& extractor() { return extractor_; }

 private:
  PrepareOptions options_;
  Camera camera_;
  OrbExtractor extractor_;
};

}  // namespace planecast::slam
