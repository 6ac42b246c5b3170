#include "slam/segmentation/decode_planes.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace planecast::slam {
namespace {

using Embedding = std::array<float, 4>;
using Values = Eigen::ArrayXf;

float logit(float probability) { return std::log(probability / (1.0F - probability)); }

/// Pixels of every second row and column: enough to find the means.
struct Samples {
  std::array<Values, 4> embedding;
  Values seed_quality;  ///< how far inside its instance; 0: no seed, or taken

  Embedding at(Eigen::Index i) const {
    return {embedding[0][i], embedding[1][i], embedding[2][i], embedding[3][i]};
  }
  Eigen::Array<bool, Eigen::Dynamic, 1> near(const Embedding& mean, float radius) const {
    return (embedding[0] - mean[0]).square() + (embedding[1] - mean[1]).square() +
               (embedding[2] - mean[2]).square() + (embedding[3] - mean[3]).square() <=
           radius * radius;
  }
};

float distance2(const Embedding& a, const Embedding& b) {
  float sum = 0.0F;
  for (std::size_t c = 0; c < 4; ++c) sum += (a[c] - b[c]) * (a[c] - b[c]);
  return sum;
}

Samples collect(const PlaneMaps& maps, const cv::Mat& planar, const cv::Mat& inner) {
  // Distance to the next boundary: seeds are taken in the middle of instances.
  cv::Mat depth;
  cv::distanceTransform(inner, depth, cv::DIST_L1, 3);
  std::array<std::vector<float>, 5> values;
  for (int y = 1; y < planar.rows; y += 2) {
    for (int x = 1; x < planar.cols; x += 2) {
      if (planar.at<unsigned char>(y, x) == 0) continue;
      for (std::size_t c = 0; c < 4; ++c) {
        values[c].push_back(maps.embedding[c].at<float>(y, x));
      }
      values[4].push_back(depth.at<float>(y, x));
    }
  }
  const auto array = [](const std::vector<float>& v) {
    return Values(Eigen::Map<const Values>(v.data(), static_cast<Eigen::Index>(v.size())));
  };
  Samples samples;
  for (std::size_t c = 0; c < 4; ++c) samples.embedding[c] = array(values[c]);
  samples.seed_quality = array(values[4]);
  return samples;
}

/// The mean to which a seed drifts.
Embedding shift(const Samples& samples, Embedding mean, const DecodeOptions& options) {
  for (int i = 0; i < options.shifts; ++i) {
    const Values inside = samples.near(mean, options.radius).cast<float>();
    const float count = std::max(inside.sum(), 1.0F);
    Embedding next;
    for (std::size_t c = 0; c < 4; ++c) next[c] = (inside * samples.embedding[c]).sum() / count;
    const bool settled = distance2(next, mean) < 1e-4F;
    mean = next;
    if (settled) break;
  }
  return mean;
}

std::vector<Embedding> find_means(Samples& samples, const DecodeOptions& options) {
  const float same2 = 0.25F * options.radius * options.radius;
  std::vector<Embedding> means;
  if (samples.seed_quality.size() == 0) return means;
  for (int i = 0; i < options.seeds; ++i) {
    Eigen::Index seed = 0;
    if (samples.seed_quality.maxCoeff(&seed) <= 0.0F) break;
    const Embedding mean = shift(samples, samples.at(seed), options);
    samples.seed_quality[seed] = 0.0F;
    samples.seed_quality = samples.near(mean, options.radius).select(0.0F, samples.seed_quality);
    const bool known = std::any_of(means.begin(), means.end(), [&](const Embedding& other) {
      return distance2(mean, other) < same2;
    });
    if (!known) means.push_back(mean);
  }
  return means;
}

/// Each planar pixel to the nearest mean within reach: 1.., or 0.
cv::Mat assign(const PlaneMaps& maps, const cv::Mat& planar, const std::vector<Embedding>& means,
               float reach) {
  const auto pixels = static_cast<Eigen::Index>(planar.total());
  const auto values = [pixels](const cv::Mat& map) {
    return Eigen::Map<const Values>(map.ptr<float>(), pixels);
  };
  Values best = Values::Constant(pixels, reach * reach);
  Values label = Values::Zero(pixels);
  for (std::size_t m = 0; m < means.size(); ++m) {
    const Values distance2 = (values(maps.embedding[0]) - means[m][0]).square() +
                             (values(maps.embedding[1]) - means[m][1]).square() +
                             (values(maps.embedding[2]) - means[m][2]).square() +
                             (values(maps.embedding[3]) - means[m][3]).square();
    label = (distance2 < best).select(static_cast<float>(m + 1), label);
    best = best.min(distance2);
  }
  cv::Mat labels;
  cv::Mat(planar.size(), CV_32F, label.data()).convertTo(labels, CV_16U);
  labels.setTo(0, planar == 0);
  return labels;
}

/// Numbers what is large enough by falling size.
void renumber(cv::Mat& labels, int count, double min_share) {
  std::vector<int> pixels(static_cast<std::size_t>(count) + 1, 0);
  for (int y = 0; y < labels.rows; ++y) {
    for (int x = 0; x < labels.cols; ++x) ++pixels[labels.at<ushort>(y, x)];
  }
  std::vector<int> order(static_cast<std::size_t>(count));
  std::iota(order.begin(), order.end(), 1);
  std::stable_sort(order.begin(), order.end(), [&pixels](int a, int b) {
    return pixels[static_cast<std::size_t>(a)] > pixels[static_cast<std::size_t>(b)];
  });
  std::vector<ushort> table(pixels.size(), 0);
  ushort next = 1;
  for (const int label : order) {
    const auto at = static_cast<std::size_t>(label);
    if (pixels[at] >= min_share * static_cast<double>(labels.total())) table[at] = next++;
  }
  for (int y = 0; y < labels.rows; ++y) {
    for (int x = 0; x < labels.cols; ++x) {
      labels.at<ushort>(y, x) = table[labels.at<ushort>(y, x)];
    }
  }
}

}  // namespace

cv::Mat decode_planes(const PlaneMaps& maps, const DecodeOptions& options) {
  const cv::Mat planar = maps.planarity > logit(options.min_planarity);
  const cv::Mat inner = planar & (maps.boundary < logit(options.min_boundary));
  Samples samples = collect(maps, planar, inner);
  const std::vector<Embedding> means = find_means(samples, options);
  cv::Mat labels = assign(maps, planar, means, 1.5F * options.radius);
  renumber(labels, static_cast<int>(means.size()), options.min_share);
  return labels;
}

}  // namespace planecast::slam
