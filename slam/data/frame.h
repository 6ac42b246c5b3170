#pragma once

#include <Eigen/Core>
#include <array>
#include <bitset>
#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "slam/data/types.h"

namespace planecast::slam {

/// 256-bit binary descriptor.
using Descriptor = std::array<std::uint64_t, 4>;

/// Number of differing bits, 0..256.
inline int hamming_distance(const Descriptor& a, const Descriptor& b) {
  return __builtin_popcountll(a[0] ^ b[0]) + __builtin_popcountll(a[1] ^ b[1]) +
         __builtin_popcountll(a[2] ^ b[2]) + __builtin_popcountll(a[3] ^ b[3]);
}

/// One image of the sequence as SLAM gets it.
struct FrameInput {
  int index = 0;           ///< in the whole sequence
  double timestamp = 0.0;  ///< seconds
  cv::Mat image;           ///< 8-bit BGR or grey, raw pixels
  cv::Mat depth;           ///< CV_32F metres along z, raw pixels, 0 = no measurement; may be empty
  cv::Mat labels;          ///< CV_16U plane instance labels, raw pixels, 0 = none; may be empty
};

struct Keypoint {
  Eigen::Vector2f raw;    ///< raw pixel
  Eigen::Vector2f pixel;  ///< undistorted pixel
  float angle_deg = 0.0F;
  float response = 0.0F;
  int octave = 0;
  float depth = 0.0F;  ///< metres along z; 0 = none
  int label = 0;       ///< plane instance in this image; 0 = none (or not segmented)
};

/// Keypoints of one image, with a grid over the undistorted image for look-ups by position.
struct Features {
  std::vector<Keypoint> keypoints;
  std::vector<Descriptor> descriptors;

  /// Fills the grid; call once after the keypoints are complete.
  void build_grid(int width, int height);
  /// Appends to `found` the indices of the keypoints within a square of half side `radius_px` about
  /// `pixel`, with min_octave <= octave <= max_octave, in a fixed order.
  void find_in_area(const Eigen::Vector2d& pixel, double radius_px, int min_octave, int max_octave,
                    std::vector<int>& found) const;
  int size() const { return static_cast<int>(keypoints.size()); }

 private:
  int grid_cols_ = 0;
  int grid_rows_ = 0;
  std::vector<int> cell_begin_;  ///< size cols*rows+1
  /// What a look-up asks for, together in memory.
  struct CellItem {
    float x = 0.0F;
    float y = 0.0F;
    int octave = 0;
    int keypoint = 0;
  };
  std::vector<CellItem> cell_items_;
};

/// A grey image (8-bit) and its halves, finest first.
struct ImagePyramid {
  std::vector<cv::Mat> levels;
};

/// Levels of the features' pyramid: level l is scaled down by factor^l.
struct ScaleLevels {
  int levels = 8;
  double factor = 1.2;

  double scale(int octave) const;
  /// Standard deviation of a keypoint's position in pixels of the full image: 1 px at its level.
  double sigma_px(int octave) const { return scale(octave); }
};

}  // namespace planecast::slam
