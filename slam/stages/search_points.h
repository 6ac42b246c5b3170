#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "slam/data/camera.h"
#include "slam/data/map.h"
#include "slam/features/orb.h"
#include "slam/features/place_points.h"
#include "slam/stages/map_points.h"

namespace planecast::slam {

struct SearchPointsOptions {
  int neighbours = 3;    ///< keyframes whose keypoints are looked for
  int max_points = 175;  ///< keypoints of a keyframe that are looked for, strongest first
  int max_searches = 3;  ///< in which a keypoint may be looked for in vain
  /// Of the neighbour's median depth: with less, most points would fail the parallax test.
  double min_baseline_share = 0.02;
  double nearest_depth = 0.5;   ///< of the 5th percentile of the keyframe's depths
  double farthest_depth = 2.0;  ///< of the 95th
  int max_steps = 50;           ///< along an epipolar line, at the level where it is searched
  int coarser_levels = 2;       ///< above a keypoint's own at which a long line may be searched
  double min_correlation = 0.8;
  double max_runner_up = 0.9;  ///< correlation elsewhere on the line, as a share of the best
  double snap_px = 2.0;        ///< as in DescribeKeyframeOptions
  PointMappingOptions points;
};

/// How often each keypoint without a landmark was looked for in newer keyframes.
class SearchLog {
 public:
  /// Counts of a keyframe's keypoints, at least `keypoints` of them.
  std::vector<std::uint8_t>& of(KeyframeId keyframe, std::size_t keypoints);

 private:
  std::vector<std::vector<std::uint8_t>> counts_;
};

/// A keypoint of a neighbour that was found in the new keyframe.
struct Sighting {
  std::vector<Observation> seen;  ///< by the neighbours, the first of which gave the position
  FoundPoint point;               ///< in the new keyframe
  Eigen::Vector3d position;       ///< world
};

/// What can be seen anew in `keyframe`, by the looks of its neighbours' keypoints: the surroundings
/// of each one without a landmark are searched along its epipolar line in the new keyframe, between
/// depths that the neighbour's landmarks suggest, and aligned to a fraction of a pixel. Needs no
/// detector to fire twice at one place, so that it works where noise or blur make it fail.
/// Precondition: the keyframe's image pyramid is there.
std::vector<Sighting> search_points(const Map& map, KeyframeId keyframe, const Camera& camera,
                                    const SearchPointsOptions& options, SearchLog& log);

/// Makes landmarks of them. The keyframe gets keypoints for what was found, with depth from its
/// depth image where it has one, and a descriptor for each keypoint that had none. Precondition:
/// nobody else holds the keyframe's features for what they were. `image` gives the colours.
void put_sightings(Map& map, KeyframeId keyframe, const Camera& camera, const cv::Mat& image,
                   double max_keypoint_depth_m, const std::vector<Sighting>& sightings,
                   const SearchPointsOptions& options, OrbExtractor& extractor,
                   PointMappingStats& stats);

}  // namespace planecast::slam
