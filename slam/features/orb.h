#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "slam/data/camera.h"
#include "slam/data/frame.h"

namespace planecast::slam {

/// Defaults: algorithms of ORB-SLAM2 / OpenVSLAM, on which the paper builds.
struct OrbOptions {
  int features = 1000;
  ScaleLevels levels;
  int fast_threshold = 20;
  int fast_threshold_low = 7;       ///< in cells where the first finds nothing
  int fast_threshold_lowest = 2;    ///< for a whole image of low contrast (paper, ICL-NUIM)
  double low_contrast_share = 0.3;  ///< ... when fewer than this share of the features was found
  int cell_px = 32;
};

/// Oriented FAST corners spread over the image by a quad-tree, described by 256-bit rotated BRIEF.
/// Deterministic; the same extractor may be used for images of any size.
class OrbExtractor {
 public:
  explicit OrbExtractor(const OrbOptions& options);
  ~OrbExtractor();

  /// `grey`: 8-bit single channel, raw pixels. `limit`: how many features, 0 = options.features.
  /// The result has raw and undistorted pixels, no depth, no labels; its grid is built.
  Features extract(const cv::Mat& grey, const Camera& camera, int limit = 0);

  /// The same without descriptors, which are half of the time: more points may come before
  /// describe().
  Features detect(const cv::Mat& grey, const Camera& camera, int limit = 0);
  /// Makes `grey` the image of append() and describe(), as detect() and extract() do. Its pixels
  /// must not change as long as it is.
  void set_image(const cv::Mat& grey);
  /// Appends points found otherwise (raw pixel, undistorted pixel and octave are given) in the
  /// image that was set last to its `features`, without descriptors. Returns the index of each, or
  /// -1 for one too near to the border. The grid has to be built again.
  std::vector<int> append(const std::vector<Keypoint>& points, Features& features);
  /// Describes the keypoints behind the last descriptor, in the image that was set last.
  void describe(Features& features) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace planecast::slam
