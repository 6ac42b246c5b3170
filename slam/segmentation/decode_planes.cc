#include "slam/segmentation/decode_planes.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

namespace planecast::slam {
namespace {

using Values = Eigen::ArrayXf;
using Map = Eigen::Map<const Values>;

Values sigmoid(const float* logits, Eigen::Index count) {
  return 1.0F / (1.0F + (-Map(logits, count)).exp());
}

/// A step between two neighbouring pixels.
struct Step {
  int a = 0;
  int b = 0;
  float weight = 0.0F;
  float probability = 0.0F;  ///< that it leaves an instance
};

/// All steps of the grid by rising weight, equal ones (to a 256th of the largest) in the order of
/// the pixels.
std::vector<Step> sorted_steps(const PlaneMaps& maps, float embedding_weight) {
  const int cols = maps.cols();
  const Eigen::Index pixels = maps.pixels();
  std::vector<Step> steps;
  steps.reserve(2 * static_cast<std::size_t>(pixels));
  float heaviest = 1e-6F;
  for (const int stride : {1, cols}) {
    const Eigen::Index count = pixels - stride;
    Values change = Values::Zero(count);
    for (int c = 0; c < PlaneMaps::kEmbedding; ++c) {
      const float* plane = maps.embedding(c);
      change += (Map(plane + stride, count) - Map(plane, count)).square();
    }
    const Values probability = sigmoid(stride == 1 ? maps.right() : maps.down(), count);
    const Values weight = probability + embedding_weight * change.sqrt();
    for (Eigen::Index i = 0; i < count; ++i) {
      if (stride == 1 && (i + 1) % cols == 0) continue;
      heaviest = std::max(heaviest, weight[i]);
      steps.push_back(
          {static_cast<int>(i), static_cast<int>(i) + stride, weight[i], probability[i]});
    }
  }
  constexpr int kBins = 256;
  const float scale = (kBins - 1) / heaviest;
  std::array<int, kBins + 1> begin{};
  for (const Step& step : steps) ++begin[static_cast<std::size_t>(step.weight * scale) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<Step> sorted(steps.size());
  for (const Step& step : steps) {
    int& at = begin[static_cast<std::size_t>(step.weight * scale)];
    sorted[static_cast<std::size_t>(at++)] = step;
  }
  return sorted;
}

/// Disjoint sets of pixels.
class Groups {
 public:
  explicit Groups(int pixels)
      : parent_(static_cast<std::size_t>(pixels)),
        size_(parent_.size(), 1),
        widest_(parent_.size(), 0.0F) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  int find(int i) {
    while (parent_[at(i)] != i) {
      parent_[at(i)] = parent_[at(parent_[at(i)])];
      i = parent_[at(i)];
    }
    return i;
  }
  void unite(int a, int b, float weight) {
    if (size_[at(a)] < size_[at(b)]) std::swap(a, b);
    parent_[at(b)] = a;
    size_[at(a)] += size_[at(b)];
    widest_[at(a)] = std::max({weight, widest_[at(a)], widest_[at(b)]});
  }
  int size(int root) const { return size_[at(root)]; }
  /// Heaviest step that a group may take.
  float limit(int root, float coherence) const {
    return widest_[at(root)] + coherence / static_cast<float>(size_[at(root)]);
  }

 private:
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }

  std::vector<int> parent_;
  std::vector<int> size_;
  std::vector<float> widest_;
};

/// Groups of pixels; `steps` keeps those that cross between them.
Groups group_pixels(int pixels, std::vector<Step>& steps, const DecodeOptions& options) {
  Groups groups(pixels);
  const auto keep_crossing = [&steps](auto&& crosses) {
    steps.erase(std::remove_if(steps.begin(), steps.end(),
                               [&](const Step& step) { return !crosses(step); }),
                steps.end());
  };
  keep_crossing([&](const Step& step) {
    const int a = groups.find(step.a);
    const int b = groups.find(step.b);
    if (a == b) return false;
    const float limit =
        std::min(groups.limit(a, options.coherence), groups.limit(b, options.coherence));
    if (step.weight > limit) return true;
    groups.unite(a, b, step.weight);
    return false;
  });
  const double small = options.small_share * pixels;
  keep_crossing([&](const Step& step) {
    const int a = groups.find(step.a);
    const int b = groups.find(step.b);
    if (a == b) return false;
    if (groups.size(a) >= small && groups.size(b) >= small) return true;
    groups.unite(a, b, 0.0F);
    return false;
  });
  return groups;
}

/// Region of each pixel, numbered from 0 in the order of the pixels, and how many there are.
std::pair<std::vector<int>, int> number_groups(Groups& groups, int pixels) {
  std::vector<int> number(static_cast<std::size_t>(pixels), -1);
  std::vector<int> region(number.size());
  int count = 0;
  for (int i = 0; i < pixels; ++i) {
    int& of_root = number[static_cast<std::size_t>(groups.find(i))];
    if (of_root < 0) of_root = count++;
    region[static_cast<std::size_t>(i)] = of_root;
  }
  return {std::move(region), count};
}

std::vector<RegionSums> sum_regions(const PlaneMaps& maps, const std::vector<int>& region,
                                    int count) {
  const auto pixels = static_cast<Eigen::Index>(region.size());
  const Values planarity = sigmoid(maps.planarity(), pixels);
  const Map nx(maps.normal(0), pixels);
  const Map ny(maps.normal(1), pixels);
  const Map nz(maps.normal(2), pixels);
  const Values scale = (nx.square() + ny.square() + nz.square() + 1e-12F).rsqrt();
  std::vector<RegionSums> sums(static_cast<std::size_t>(count));
  for (Eigen::Index i = 0; i < pixels; ++i) {
    RegionSums& sum = sums[static_cast<std::size_t>(region[static_cast<std::size_t>(i)])];
    sum.pixels += 1.0F;
    sum.planarity += planarity[i];
    sum.normal[0] += scale[i] * nx[i];
    sum.normal[1] += scale[i] * ny[i];
    sum.normal[2] += scale[i] * nz[i];
    for (int c = 0; c < PlaneMaps::kEmbedding; ++c) {
      sum.embedding[static_cast<std::size_t>(c)] += maps.embedding(c)[i];
    }
  }
  return sums;
}

/// Label of each region: planar ones by falling size, parts of one plane together.
std::vector<int> label_regions(const RegionGraph& graph, double pixels,
                               const DecodeOptions& options) {
  std::vector<int> roots;
  for (int r = 0; r < graph.count(); ++r) {
    const RegionSums& sums = graph.sums(r);
    if (graph.root(r) == r && sums.planarity >= options.min_planarity * sums.pixels) {
      roots.push_back(r);
    }
  }
  const auto larger = [](float a, float b) { return a > b; };
  std::stable_sort(roots.begin(), roots.end(), [&](int a, int b) {
    return larger(graph.sums(a).pixels, graph.sums(b).pixels);
  });
  std::vector<int> plane_of(static_cast<std::size_t>(graph.count()), -1);
  std::vector<int> first;  // region of each plane
  std::vector<float> size;
  for (const int root : roots) {
    const auto same = std::find_if(first.begin(), first.end(), [&](int other) {
      return RegionSums::distance(graph.sums(root), graph.sums(other)) < options.same_distance &&
             RegionSums::cosine(graph.sums(root), graph.sums(other)) > options.same_cosine;
    });
    const auto plane = static_cast<std::size_t>(same - first.begin());
    if (same == first.end()) {
      first.push_back(root);
      size.push_back(0.0F);
    }
    size[plane] += graph.sums(root).pixels;
    plane_of[static_cast<std::size_t>(root)] = static_cast<int>(plane);
  }
  std::vector<int> order(first.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return larger(size[static_cast<std::size_t>(a)], size[static_cast<std::size_t>(b)]);
  });
  std::vector<int> label_of(first.size(), 0);
  int next = 1;
  for (const int plane : order) {
    if (size[static_cast<std::size_t>(plane)] < options.min_share * pixels) break;
    label_of[static_cast<std::size_t>(plane)] = next++;
  }
  std::vector<int> labels;
  for (int r = 0; r < graph.count(); ++r) {
    const int plane = plane_of[static_cast<std::size_t>(graph.root(r))];
    labels.push_back(plane < 0 ? 0 : label_of[static_cast<std::size_t>(plane)]);
  }
  return labels;
}

}  // namespace

PlaneMaps::PlaneMaps(int rows, int cols)
    : rows_(rows),
      cols_(cols),
      values_(static_cast<std::size_t>(kFine + kCoarse) * static_cast<std::size_t>(rows * cols)) {}

PlaneMaps PlaneMaps::of(const float* block, int rows, int cols) {
  PlaneMaps maps(rows, cols);
  const int cell_rows = rows / 2;
  const int cell_cols = cols / 2;
  for (int index = 0; index < kFine; ++index) {
    for (int corner = 0; corner < 4; ++corner) {
      float* out = maps.plane(index) + corner / 2 * cols + corner % 2;
      for (int y = 0; y < cell_rows; ++y, out += 2 * cols) {
        for (int x = 0; x < cell_cols; ++x) out[2 * x] = *block++;
      }
    }
  }
  for (int index = kFine; index < kFine + kCoarse; ++index) {
    const cv::Mat coarse(cell_rows, cell_cols, CV_32F, const_cast<float*>(block));
    cv::Mat fine(rows, cols, CV_32F, maps.plane(index));
    cv::resize(coarse, fine, fine.size(), 0, 0, cv::INTER_LINEAR);
    block += cell_rows * cell_cols;
  }
  return maps;
}

cv::Mat decode_planes(const PlaneMaps& maps, const DecodeOptions& options) {
  const int pixels = maps.pixels();
  std::vector<Step> steps = sorted_steps(maps, options.embedding_weight);
  Groups groups = group_pixels(pixels, steps, options);
  const auto [region, count] = number_groups(groups, pixels);
  RegionGraph graph(sum_regions(maps, region, count));
  for (const Step& step : steps) {
    const int a = region[static_cast<std::size_t>(step.a)];
    const int b = region[static_cast<std::size_t>(step.b)];
    if (a != b) graph.add_border(a, b, step.probability);
  }
  graph.merge(options.costs);
  const std::vector<int> label_of = label_regions(graph, pixels, options);
  cv::Mat labels(maps.rows(), maps.cols(), CV_16U);
  for (int i = 0; i < pixels; ++i) {
    labels.at<ushort>(i / maps.cols(), i % maps.cols()) = static_cast<ushort>(
        label_of[static_cast<std::size_t>(region[static_cast<std::size_t>(i)])]);
  }
  return labels;
}

}  // namespace planecast::slam
