#include "engine/evaluate/visibility.h"

#include <map>
#include <opencv2/core.hpp>

namespace planecast::engine {

std::set<int> labels_in_view(Sequence& sequence, double min_share, int step) {
  std::set<int> seen;
  if (!sequence.has_labels()) return seen;
  for (int index = sequence.first_frame(); index < sequence.end_frame(); index += step) {
    const cv::Mat labels = sequence.read(index).labels;
    std::map<int, int> pixels;
    for (int row = 0; row < labels.rows; ++row) {
      for (int col = 0; col < labels.cols; ++col) ++pixels[labels.at<std::uint16_t>(row, col)];
    }
    for (const auto& [label, count] : pixels) {
      if (label != 0 && count >= min_share * static_cast<double>(labels.total()))
        seen.insert(label);
    }
  }
  return seen;
}

}  // namespace planecast::engine
