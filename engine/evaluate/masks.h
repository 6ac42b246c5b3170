#pragma once

#include <nlohmann/json_fwd.hpp>
#include <opencv2/core.hpp>
#include <string>

#include "engine/evaluate/partition.h"
#include "engine/sequence/sequence.h"

namespace planecast::engine {

struct MaskOptions {
  double min_iou = 0.5;           ///< of a true instance and its match
  double min_true_share = 0.002;  ///< of the image; smaller true instances need not be found
};

/// Plane instances of one picture against the true ones.
struct MaskScore {
  int truth = 0;  ///< true instances that must be found
  int estimated = 0;
  int found = 0;             ///< overlapped by an estimated instance with min_iou
  PartitionScore partition;  ///< over all pixels, those off the planes being a group as well
};

/// Labels are CV_16U of one size, 0 = not planar.
MaskScore score_masks(const cv::Mat& estimate, const cv::Mat& truth,
                      const MaskOptions& options = {});

/// Over the frames that both sequences have.
struct MaskResult {
  int frames = 0;
  int without_estimate = 0;  ///< true frames that have no estimated mask: nothing found there
  int truth = 0;
  int estimated = 0;
  int found = 0;
  double recall = 0.0;      ///< found / truth, instances of all frames together
  double precision = 0.0;   ///< found / estimated
  double rand_index = 0.0;  ///< these three: mean over the frames with both masks
  double variation_of_information = 0.0;
  double segmentation_covering = 0.0;
};

/// Adds up frames.
class MaskSums {
 public:
  void add(const MaskScore& score);
  /// A frame without an estimated mask: nothing is found, and the partitions are not compared.
  void add_without_estimate(const MaskScore& score);
  MaskResult result() const;

 private:
  MaskResult sums_;
};

/// `masks`: a folder with mask.txt (as `segment` writes it) or a sequence that has one. Its times
/// are paired with the true sequence's frames within 20 ms; a mask of another size is resized.
/// Throws UserError where either has no masks or no frame has both.
MaskResult evaluate_masks(const std::filesystem::path& masks, Sequence& truth,
                          const MaskOptions& options = {});

std::string format_table(const MaskResult& result);
nlohmann::ordered_json to_json(const MaskResult& result);

}  // namespace planecast::engine
