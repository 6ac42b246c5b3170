#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "slam/fitting/graph_cut_ransac.h"

namespace planecast::slam {

/// The order of sequential fitting: points by mask label (> 0), biggest group first, ties by label
/// [D]. Groups smaller than `min_size` are left out.
inline std::vector<std::vector<int>> groups_by_label(const std::vector<int>& labels, int min_size) {
  std::vector<std::pair<int, int>> by_label;  // (label, point)
  for (int i = 0; i < static_cast<int>(labels.size()); ++i) {
    if (labels[i] > 0) by_label.emplace_back(labels[i], i);
  }
  std::sort(by_label.begin(), by_label.end());
  std::vector<std::vector<int>> groups;
  for (std::size_t begin = 0, end = 0; begin < by_label.size(); begin = end) {
    std::vector<int> group;
    for (end = begin; end < by_label.size() && by_label[end].first == by_label[begin].first;
         ++end) {
      group.push_back(by_label[end].second);
    }
    if (static_cast<int>(group.size()) >= min_size) groups.push_back(std::move(group));
  }
  std::stable_sort(groups.begin(), groups.end(),
                   [](const auto& a, const auto& b) { return a.size() > b.size(); });
  return groups;
}

/// Sequential fitting without masks: `fit(pool)` fits one model to the points of the pool and
/// returns those that it consumes, which leave it; ends when nothing is consumed, when fewer than
/// `min_size` are left or after `max_models`.
template <typename Fit>
void fit_sequentially(std::vector<int> pool, int min_size, int max_models, Fit fit) {
  for (int k = 0; k < max_models && static_cast<int>(pool.size()) >= min_size; ++k) {
    std::vector<int> consumed = fit(pool);
    if (consumed.empty()) return;
    std::sort(consumed.begin(), consumed.end());
    const auto is_consumed = [&](int i) {
      return std::binary_search(consumed.begin(), consumed.end(), i);
    };
    pool.erase(std::remove_if(pool.begin(), pool.end(), is_consumed), pool.end());
  }
}

}  // namespace planecast::slam
