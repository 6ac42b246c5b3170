#include "engine/evaluate/partition.h"

#include <algorithm>
#include <cmath>

namespace planecast::engine {
namespace {

using Counts = std::map<int, double>;

double pairs_among(double count) { return 0.5 * count * (count - 1.0); }

double entropy_of(const Counts& counts, double total) {
  double entropy = 0.0;
  for (const auto& [label, count] : counts) entropy -= count / total * std::log(count / total);
  return entropy;
}

double pairs_together(const Counts& counts) {
  double pairs = 0.0;
  for (const auto& [label, count] : counts) pairs += pairs_among(count);
  return pairs;
}

}  // namespace

PartitionScore score_partition(const LabelPairs& pairs) {
  PartitionScore score;
  Counts truth;
  Counts estimated;
  for (const auto& [labels, count] : pairs) {
    truth[labels.first] += static_cast<double>(count);
    estimated[labels.second] += static_cast<double>(count);
    score.elements += count;
  }
  if (score.elements < 2) return score;
  const auto total = static_cast<double>(score.elements);
  double together = 0.0;
  double joint_entropy = 0.0;
  Counts best_iou;
  for (const auto& [labels, whole_count] : pairs) {
    const auto count = static_cast<double>(whole_count);
    if (count <= 0.0) continue;
    together += pairs_among(count);
    joint_entropy -= count / total * std::log(count / total);
    const double united = truth[labels.first] + estimated[labels.second] - count;
    double& best = best_iou[labels.first];
    best = std::max(best, count / united);
  }
  const double disagreeing = pairs_together(estimated) + pairs_together(truth) - 2.0 * together;
  score.rand_index = 1.0 - disagreeing / pairs_among(total);
  score.variation_of_information =
      std::max(0.0, 2.0 * joint_entropy - entropy_of(estimated, total) - entropy_of(truth, total));
  for (const auto& [label, count] : truth) {
    score.segmentation_covering += count / total * best_iou[label];
  }
  return score;
}

}  // namespace planecast::engine
