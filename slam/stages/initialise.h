#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "slam/data/camera.h"
#include "slam/data/frame.h"
#include "slam/data/map.h"
#include "slam/features/corner_tracks.h"
#include "slam/geometry/two_view.h"
#include "slam/stages/prepare_image.h"
#include "slam/stages/start_bundle.h"

namespace planecast::slam {

/// Defaults from ORB-SLAM (Mur-Artal 2015, section IV) but where noted.
struct InitialiseOptions {
  bool by_patches = true;  ///< follow corners by their looks, else match ORB descriptors
  CornerTracksOptions tracks;
  double min_track_share = 0.3;  ///< of the reference's corners still followed, else it is replaced
  double snap_px = 2.0;          ///< as in DescribeKeyframeOptions
  int features = 2000;           ///< of the two images [K]
  int min_features = 100;        ///< in the reference image
  int min_matches = 100;         ///< else the reference is replaced
  double window_px = 100.0;      ///< at 640 px image width, scaled with it
  double homography_share = 0.45;  ///< H when S_H / (S_H + S_F) is above it [P]
  int max_reference_age = 90;      ///< frames after which a reference without parallax is replaced
  int min_landmarks = 50;
  double max_rms_px = 2.0;  ///< of the two-view bundle: a worse start is no start
  TwoViewOptions two_view;
  /// Two views with less parallax than two_view asks for, but at least this, may still start if all
  /// frames since the reference together fix the depths (by_patches alone).
  double bundle_parallax_deg = 0.4;
  /// Up to this focal length, more parallax is asked of a shorter one: 640 pixels wide, 60 degrees.
  double parallax_focal_px = 554.0;
  StartBundleOptions start_bundle;
  std::uint64_t seed = 1;
  ScaleLevels levels;
};

struct InitialiseResult {
  bool done = false;
  std::string reason;  ///< why not, for frames.csv
  bool used_homography = false;
  int matches = 0;
};

/// Monocular start: H by graph-cut RANSAC and F by the 8-point algorithm in parallel, the relative
/// pose of the better model, two keyframes, bundle adjustment, median depth 1 (paper, "System
/// Initialization and Map Initialization").
class MonoInitialiser {
 public:
  MonoInitialiser(const InitialiseOptions& options, const PrepareOptions& prepare,
                  const Camera& camera);

  /// Tries the image against the reference. On success `map` (empty before) holds keyframes 0 (the
  /// reference, at the origin) and 1 (this image) and their landmarks. The image is given features
  /// where they are needed.
  InitialiseResult try_image(ImageFeatures& image, Map& map);
  void reset() {
    reference_.reset();
    way_before_.reset();
  }
  const std::optional<ImageFeatures>& reference() const { return reference_; }

 private:
  struct Matches {
    std::vector<std::pair<int, int>>
        keypoints;  ///< (reference, image); the image's only by descriptors
    std::vector<PointPair> pairs;
    std::vector<float> quality;  ///< lower is better
  };
  bool set_reference(ImageFeatures& image);
  /// Whether the image before led the same way.
  bool is_confirmed(const TwoViewResult& two_view);
  void match_tracks(const ImageFeatures& image, Matches& matches);
  /// The corners that are still followed, in every image since the reference.
  FollowedCorners followed() const;
  /// A start from all frames since the reference, where two views alone do not do.
  std::optional<StartBundle> bundle_since_reference(const TwoViewResult& two_view,
                                                    const std::vector<Pose>& candidates) const;
  void match_descriptors(const ImageFeatures& image, Matches& matches);
  /// Gives the image's keypoints to matches found by patches; those without one are left out (-1).
  void place_tracks(ImageFeatures& image, Matches& matches);
  Map two_keyframes(const ImageFeatures& image, const Matches& matches,
                    const TwoViewResult& two_view) const;
  /// Bundle adjustment of the two keyframes; false where it does not fit.
  bool adjust(Map& start);
  /// The relative pose of the better model; `candidates`: those of both.
  TwoViewResult solve(const std::vector<PointPair>& pairs, const std::vector<float>& quality,
                      bool& used_homography, std::vector<Pose>& candidates) const;

  InitialiseOptions options_;
  Camera camera_;
  ImagePreparer preparer_;
  std::optional<ImageFeatures> reference_;
  CornerTracks tracks_;
  /// (keypoint of the reference, undistorted pixel) for each image since the reference, in the
  /// order of the tracks, of which each image has some of those of the image before.
  std::vector<std::vector<std::pair<int, Eigen::Vector2d>>> history_;
  std::vector<Eigen::Vector2d> guess_;
  /// Where the camera went by the image before, if that could have started: unit, in the reference.
  std::optional<Eigen::Vector3d> way_before_;
};

/// RGB-D start from one image: a landmark for each keypoint with depth. Fails with too few of them.
InitialiseResult initialise_rgbd(const ImageFeatures& image, const Camera& camera,
                                 const ScaleLevels& levels, int min_landmarks, Map& map);

/// A keyframe of the image; it has no landmarks yet. `map` gives the id.
Keyframe make_keyframe(const ImageFeatures& image, const Pose& cam_from_world, const Map& map);

/// Colour of the image at a raw pixel, RGB 0..255.
Eigen::Vector3f color_at(const cv::Mat& grey_or_bgr, const Eigen::Vector2f& raw_pixel);

}  // namespace planecast::slam
