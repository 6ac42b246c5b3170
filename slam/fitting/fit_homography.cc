#include "slam/fitting/fit_homography.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

#include "slam/fitting/graph_cut_ransac.h"
#include "slam/fitting/homography_model.h"
#include "slam/fitting/neighbourhood.h"
#include "slam/fitting/samplers.h"
#include "slam/fitting/sequential.h"

namespace planecast::slam {

namespace {

/// Indices best first. Without qualities the order is random: keypoints may come sorted by
/// position, which would make the progressive sampler look at one corner first.
std::vector<int> order_by_quality(std::size_t n, const std::vector<float>& quality,
                                  std::uint64_t seed) {
  std::vector<int> order(n);
  std::iota(order.begin(), order.end(), 0);
  if (quality.size() == n) {
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return quality[a] < quality[b]; });
    return order;
  }
  Random random(seed);
  for (std::size_t i = n; i > 1; --i)
    std::swap(order[i - 1], order[random.below(static_cast<int>(i))]);
  return order;
}

RansacOptions ransac_options(const HomographyOptions& options, std::uint64_t seed) {
  const double scale = options.image_width / 640.0;
  RansacOptions result;
  result.threshold = options.threshold_px * scale;
  result.max_rms = options.max_rms_px * scale;
  result.lambda = options.lambda;
  // A plane's leak is told by its neighbours, which share its residuals; a match is told by its
  // own.
  result.pairs_by_contrast = true;
  result.min_inliers = options.min_inliers;
  result.min_inlier_ratio = options.min_inlier_ratio;
  result.graph_cut = options.graph_cut;
  result.seed = seed;
  return result;
}

using Result = RansacResult<HomographyModel::Parameters>;

Result fit_group(const std::vector<PointPair>& group, const HomographyOptions& options,
                 std::uint64_t seed) {
  const HomographyModel model(group);
  if (group.size() < static_cast<std::size_t>(HomographyModel::kSampleSize)) return {};
  GridOptions grid;
  if (options.all_pairs) grid.max_neighbours = kAllPairs;
  std::vector<NeighbourPair> neighbours;
  if (options.graph_cut) {
    neighbours = image_grid_neighbours(group, options.image_width, options.image_height, grid);
  }
  ProgressiveNapsacSampler sampler(group, options.image_width, options.image_height,
                                   HomographyModel::kSampleSize);
  return GraphCutRansac(model, sampler, neighbours, ransac_options(options, seed)).run();
}

HomographyFit make_fit(const Result& result, int label) {
  HomographyFit fit;
  fit.cur_H_ref = result.model.cur_H_ref;
  if (std::abs(fit.cur_H_ref(2, 2)) > 1e-12) fit.cur_H_ref /= result.model.cur_H_ref(2, 2);
  fit.label = label;
  fit.samples = result.samples;
  fit.rounds = result.rounds;
  fit.cuts = result.cuts;
  return fit;
}

/// Marks the pairs within the threshold, whatever group they are in.
void count_over_all(const HomographyModel::Parameters& model, const std::vector<PointPair>& pairs,
                    double threshold, HomographyFit& fit) {
  std::vector<double> squared(pairs.size());
  HomographyModel(pairs).squared_residuals(model, 0, static_cast<int>(pairs.size()),
                                           squared.data());
  fit.inlier.assign(pairs.size(), 0);
  double sum = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (squared[i] >= threshold * threshold) continue;
    fit.inlier[i] = 1;
    ++fit.num_inliers;
    sum += squared[i];
  }
  fit.rms_px = std::sqrt(sum / std::max(fit.num_inliers, 1));
}

std::vector<PointPair> select(const std::vector<PointPair>& pairs,
                              const std::vector<int>& indices) {
  std::vector<PointPair> result;
  result.reserve(indices.size());
  for (const int i : indices) result.push_back(pairs[i]);
  return result;
}

/// The best of one fit per plane instance; `order` lists the pairs best first.
std::optional<HomographyFit> fit_instances(const std::vector<PointPair>& pairs,
                                           const std::vector<int>& labels,
                                           const std::vector<int>& order,
                                           const HomographyOptions& options) {
  std::vector<int> sorted_labels;
  sorted_labels.reserve(order.size());
  for (const int i : order) sorted_labels.push_back(labels[i]);
  std::optional<HomographyFit> best;
  for (std::vector<int>& group : groups_by_label(sorted_labels, options.min_inliers)) {
    for (int& i : group) i = order[i];
    const int label = labels[group.front()];
    const Result result = fit_group(select(pairs, group), options,
                                    mix_seed(options.seed, static_cast<std::uint64_t>(label)));
    if (!result.accepted) continue;
    HomographyFit fit = make_fit(result, label);
    count_over_all(result.model, pairs, ransac_options(options, 0).threshold, fit);
    if (!best || fit.num_inliers > best->num_inliers) best = std::move(fit);
  }
  return best;
}

}  // namespace

std::optional<HomographyFit> fit_homography(const std::vector<PointPair>& pairs,
                                            const std::vector<float>& quality,
                                            const std::vector<int>& labels,
                                            const HomographyOptions& options) {
  const std::vector<int> order = order_by_quality(pairs.size(), quality, options.seed);
  if (labels.size() == pairs.size()) {
    if (auto fit = fit_instances(pairs, labels, order, options)) return fit;
  }
  const Result result = fit_group(select(pairs, order), options, mix_seed(options.seed, 0));
  if (!result.accepted) return std::nullopt;
  HomographyFit fit = make_fit(result, 0);
  fit.num_inliers = result.num_inliers;
  fit.rms_px = result.rms;
  fit.inlier.assign(pairs.size(), 0);
  for (std::size_t i = 0; i < order.size(); ++i) fit.inlier[order[i]] = result.inlier[i];
  return fit;
}

}  // namespace planecast::slam
