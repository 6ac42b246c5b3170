#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>

namespace planecast::engine {

/// The picture with its instances in the planes' colours, outlined. `labels` is CV_16U.
cv::Mat paint_masks(const cv::Mat& image, const cv::Mat& labels);

/// Writes a folder of plane masks: mask/NNNNNN.png, mask.txt that lists them by time, and, where
/// wanted, overlay/NNNNNN.png.
class MaskFolder {
 public:
  /// `segmenter`: its name, for the record. Throws UserError, as do all others.
  MaskFolder(std::filesystem::path folder, const std::string& segmenter, bool overlays);
  /// Without labels the mask is empty: nothing is known to be planar.
  void add(int index, double timestamp, const cv::Mat& image, const cv::Mat& labels);
  /// Writes the list; its path.
  std::filesystem::path finish() const;

 private:
  std::filesystem::path folder_;
  bool overlays_;
  std::string list_;
};

}  // namespace planecast::engine
