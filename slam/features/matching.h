#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "slam/data/camera.h"
#include "slam/data/frame.h"
#include "slam/data/map.h"

namespace planecast::slam {

/// Hamming limits of a 256-bit ORB descriptor [K].
inline constexpr int kStrictDistance = 50;
inline constexpr int kLooseDistance = 100;

/// A landmark expected at a pixel of an image.
struct Expectation {
  LandmarkId landmark = kNone;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< undistorted
  double radius_px = 0.0;
  int min_octave = 0;
  int max_octave = 0;
  Descriptor descriptor = {};
  float angle_deg = -1.0F;  ///< of the keypoint it was last seen as; < 0: unknown
};

struct ExpectationMatchOptions {
  int max_distance = kLooseDistance;
  double ratio = 0.9;           ///< best against second best, when both are of one octave
  bool check_rotation = false;  ///< keep the three dominant bins of the change of angle
};

/// Keypoint -> landmark for a whole image. `taken[k]` != kNone marks keypoints that are not to be
/// matched again; pass an empty vector for none. Each keypoint and each landmark is used once (the
/// nearer descriptor wins). Returns pairs (keypoint, index into expectations), ascending by
/// keypoint.
std::vector<std::pair<int, int>> match_expectations(const Features& features,
                                                    const std::vector<Expectation>& expectations,
                                                    const std::vector<LandmarkId>& taken,
                                                    const ExpectationMatchOptions& options);

/// Octave at which a landmark at `distance` is expected, given its distance range.
int predict_octave(const Landmark& landmark, double distance, const ScaleLevels& levels);

/// Where and how `landmark` should appear in a camera: nothing if it is outside the image, out of
/// its distance range or seen from more than 60 degrees off its mean viewing direction.
bool expect_landmark(const Landmark& landmark, const Camera& camera, const Pose& cam_from_world,
                     const ScaleLevels& levels, Expectation& expectation);

/// Matches for the monocular initialisation: keypoints of octave 0 only, near where they were seen
/// last. `guess` (size of ref) is updated to the matched pixels. Pairs (ref, cur), ascending by
/// ref.
std::vector<std::pair<int, int>> match_for_initialisation(const Features& ref, const Features& cur,
                                                          std::vector<Eigen::Vector2d>& guess,
                                                          double window_px);

/// Brute-force matches of the keypoints of `from` that `use_from` marks with those of `to`; ratio
/// and rotation checked, one to one. Pairs (from, to), ascending by from.
std::vector<std::pair<int, int>> match_brute_force(const Features& from,
                                                   const std::vector<char>& use_from,
                                                   const Features& to, int max_distance,
                                                   double ratio);

/// Matches of keypoints without landmarks between two keyframes along epipolar lines, for
/// triangulation. Pairs (keypoint in a, keypoint in b), ascending by the first.
std::vector<std::pair<int, int>> match_along_epipolar(const Keyframe& a, const Keyframe& b,
                                                      const Camera& camera,
                                                      const ScaleLevels& levels);

}  // namespace planecast::slam
