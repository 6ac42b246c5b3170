#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace planecast::engine {

/// The picture with its instances in the planes' colours, outlined. `labels` is CV_16U.
cv::Mat paint_masks(const cv::Mat& image, const cv::Mat& labels);

struct MaskRecord {
  int frame = 0;
  double timestamp = 0.0;
  std::string file;  ///< below the folder
  int instances = 0;
};

/// Writes a folder of plane masks: mask/NNNNNN.png, mask.txt that lists them by time, and, where
/// wanted, overlay/NNNNNN.png.
class MaskFolder {
 public:
  /// `segmenter`: its name, for the record. Throws UserError, as do all others.
  MaskFolder(std::filesystem::path folder, std::string segmenter, bool overlays);
  /// Without labels the mask is empty: nothing is known to be planar.
  void add(int index, double timestamp, const cv::Mat& image, const cv::Mat& labels);
  /// Writes the list; its path.
  std::filesystem::path finish() const;
  const std::string& segmenter() const { return segmenter_; }
  const std::vector<MaskRecord>& masks() const { return masks_; }

 private:
  std::filesystem::path folder_;
  std::string segmenter_;
  bool overlays_;
  std::vector<MaskRecord> masks_;
};

}  // namespace planecast::engine
