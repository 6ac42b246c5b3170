#pragma once

#include <map>
#include <utility>

namespace planecast::engine {

/// How many elements carry each pair of labels (of the truth, of the estimate).
using LabelPairs = std::map<std::pair<int, int>, long long>;

/// How well two groupings of the same elements agree.
struct PartitionScore {
  long long elements = 0;
  double rand_index = 0.0;                ///< RI, 1 is best
  double variation_of_information = 0.0;  ///< VOI in nats, 0 is best
  double segmentation_covering = 0.0;     ///< SC of the truth by the estimate, 1 is best
};

/// All zero for fewer than two elements.
PartitionScore score_partition(const LabelPairs& pairs);

}  // namespace planecast::engine
