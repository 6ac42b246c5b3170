#pragma once

#include <optional>
#include <vector>

#include "slam/data/camera.h"
#include "slam/data/map.h"
#include "slam/stages/initialise.h"

namespace planecast::slam {

/// Defaults [K].
struct PointMappingOptions {
  int neighbours_mono = 20;
  int neighbours_rgbd = 10;
  int fuse_neighbours = 10;  ///< in which, and in whose neighbours, duplicates are looked for
  double min_found_ratio = 0.25;
  int trial_keyframes = 3;  ///< a landmark is on trial for so many keyframes
  double min_parallax_cosine = 0.9998;
  double chi2_mono = 5.991;
  double min_baseline_share = 0.01;  ///< of the median depth (mono); RGB-D: 0.08 m
  double min_baseline_m = 0.08;
  double redundant_share = 0.9;  ///< keyframe culling
  int redundant_observers = 3;
  double max_landmark_depth_m = 6.0;  ///< RGB-D: depth beyond it is too noisy to make landmarks
  ScaleLevels levels;
};

struct PointMappingStats {
  int culled = 0;
  int triangulated = 0;
  int from_depth = 0;
  int fused = 0;
  int keyframes_culled = 0;
};

/// Keyframes that share most landmarks with `keyframe`, most first.
std::vector<KeyframeId> best_neighbours(const Map& map, KeyframeId keyframe, std::size_t most);

/// Whether two keyframes are far enough apart to triangulate.
bool wide_enough(const Map& map, const Keyframe& keyframe, const Keyframe& neighbour, bool rgbd,
                 const PointMappingOptions& options);

/// The point that two keypoints see: parallax, positive depth, reprojection (chi2) and the ratio of
/// their octaves must agree.
std::optional<Eigen::Vector3d> point_from_two(const Camera& camera, const Keyframe& a,
                                              const Keypoint& in_a, const Keyframe& b,
                                              const Keypoint& in_b,
                                              const PointMappingOptions& options);

/// A new landmark without observations.
LandmarkId put_landmark(Map& map, const Eigen::Vector3d& position, KeyframeId keyframe,
                        const cv::Mat& image, const Keypoint& keypoint);

/// Removes landmarks on trial that are found too rarely or have too few observers.
void cull_landmarks(Map& map, KeyframeId keyframe, bool rgbd, const PointMappingOptions& options,
                    PointMappingStats& stats);

/// New landmarks of `keyframe` with its covisible keyframes; in RGB-D also from depth where a
/// keypoint still has none. `image` gives the colours.
void create_landmarks(Map& map, KeyframeId keyframe, const Camera& camera, bool rgbd,
                      const cv::Mat& image, const PointMappingOptions& options,
                      PointMappingStats& stats);

/// A new landmark for each keypoint with depth that still has none.
void create_landmarks_from_depth(Map& map, KeyframeId keyframe, const Camera& camera,
                                 const cv::Mat& image, const PointMappingOptions& options,
                                 PointMappingStats& stats);

/// Merges duplicates between `keyframe` and its neighbours, both ways.
void fuse_landmarks(Map& map, KeyframeId keyframe, const Camera& camera,
                    const PointMappingOptions& options, PointMappingStats& stats);

/// Projects `candidates` into `keyframe` and joins each with what it finds there.
void fuse_landmarks_into(Map& map, const std::vector<LandmarkId>& candidates, KeyframeId keyframe,
                         const Camera& camera, const PointMappingOptions& options,
                         PointMappingStats& stats);

/// Removes keyframes about `keyframe` most of whose landmarks others see as well. Never the first
/// two, nor `keyframe` itself.
void cull_keyframes(Map& map, KeyframeId keyframe, const PointMappingOptions& options,
                    PointMappingStats& stats);

}  // namespace planecast::slam
