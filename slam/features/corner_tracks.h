#pragma once

#include <Eigen/Core>
#include <vector>

#include "slam/data/frame.h"
#include "slam/data/types.h"
#include "slam/features/patch.h"

namespace planecast::slam {

struct CornerTracksOptions {
  int max_tracks = 800;           ///< strongest corners first
  int levels = 4;                 ///< of the pyramid, from a corner's own upwards
  double min_correlation = 0.75;  ///< at the finest
  float max_shift_px = 4.0F;      ///< at each level
  ScaleLevels scale_levels;
};

/// A corner of the reference image, followed to the last image.
struct CornerTrack {
  int keypoint = kNone;  ///< of the reference
  Eigen::Vector2f raw;   ///< raw pixel in the last image
  float correlation = 1.0F;
};

/// Corners of a reference image that are followed from image to image. Each image is compared with
/// the reference itself, so that nothing drifts; a corner that is not found is lost for good.
class CornerTracks {
 public:
  explicit CornerTracks(const CornerTracksOptions& options) : options_(options) {}

  /// Starts anew.
  void start(const ImagePyramid& reference, const Features& features);
  void follow(const ImagePyramid& image);

  const std::vector<CornerTrack>& tracks() const { return tracks_; }
  int started() const { return started_; }

 private:
  struct Looks {
    int level = 0;
    PatchTemplate patch;
  };
  bool follow(const ImagePyramid& image, const std::vector<Looks>& looks, CornerTrack& track) const;

  CornerTracksOptions options_;
  std::vector<CornerTrack> tracks_;
  std::vector<std::vector<Looks>> looks_;  ///< per track, coarsest first
  int started_ = 0;
};

}  // namespace planecast::slam
