#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "slam/data/camera.h"
#include "slam/data/map.h"

namespace planecast::slam {

struct StereoDepthOptions {
  int threads = 1;  ///< pairs that are compared at once; changes no result
  int width = 240;  ///< of the images that are compared
  /// Pairs of a keyframe, of which two must agree: what smoothing makes of a slope is another thing
  /// in each.
  int pairs = 4;
  double max_disagreement = 0.02;  ///< of the depth
  double best_baseline = 0.18;     ///< of the keyframe's median depth
  double min_baseline = 0.06;
  double max_baseline = 0.4;
  double min_view_cosine = 0.85;  ///< between the two cameras' directions
  double max_forward = 0.6;       ///< share of the motion that may be along them
};

/// The keyframes that see the same as `own` from beside it and do not stand at one place, best
/// first.
std::vector<const Keyframe*> keyframes_beside(const Map& map, const Keyframe& own,
                                              const StereoDepthOptions& options);

/// Depth of the keyframes of a finished monocular map, by what they see of each other: pairs of
/// them are rectified by the map's poses and compared by semi-global matching (Hirschmueller 2008,
/// OpenCV). Surfaces on which no corner was found have depth by it.
class StereoDepth {
 public:
  StereoDepth(const Camera& camera, const StereoDepthOptions& options);

  /// CV_32F, map units, raw pixels; 0 where it is not known. Empty where fewer than two keyframes
  /// stand beside this one, or have no image.
  cv::Mat of(const Map& map, KeyframeId keyframe) const;

 private:
  /// CV_32F, inverse depth at the pixels of rays_; 0 where it is not known.
  cv::Mat compare(const Keyframe& left, const Keyframe& right, double nearest) const;
  cv::Mat agreed(const std::vector<cv::Mat>& inverse_depths) const;

  Camera camera_;
  StereoDepthOptions options_;
  cv::Mat rays_;
};

}  // namespace planecast::slam
