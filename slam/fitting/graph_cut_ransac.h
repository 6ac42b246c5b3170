#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "slam/fitting/graph_cut.h"
#include "slam/fitting/kernel.h"
#include "slam/fitting/neighbourhood.h"
#include "slam/geometry/random.h"

namespace planecast::slam {

/// Graph-Cut RANSAC with the outer loop and the residual threshold of Shu et al., "Visual SLAM with
/// Graph-Cut Optimized Multi-Plane Reconstruction" (ISMAR 2021), Algorithm 1. Distances are in the
/// unit of the model's residual (pixels or map units).
struct RansacOptions {
  double threshold = 2.0;  ///< eps_d: inlier distance
  double max_rms = 1.0;    ///< eps_L: accepted RMS of the inliers' distances
  /// Spatial coherence. [D] Divided over the neighbours, so that all pairs together weigh as much
  /// as all points: with eight neighbours of full weight each, a point at the border of what a mask
  /// leaked in is labelled by its neighbours alone.
  double lambda = 0.975;
  bool pairs_by_contrast = false;  ///< PairOptions::by_contrast
  /// [D] Charged for each point between 1 and 3 thresholds. At 0.6 points strewn evenly through
  /// space score nothing; 0 is the plain score.
  double background_cost = 0.0;
  double confidence = 0.99;     ///< mu of the stopping rule [P]
  int max_rounds = 50;          ///< N, outer loop [P]
  int max_inner = 1000;         ///< [D] bound of N_GC
  int max_samples = 3000;       ///< [D] bound over all rounds: hopeless data must cost little
  int max_stagnant_rounds = 3;  ///< [D] outer rounds without a better model end the search
  int subsets_per_cut = 4;  ///< [D] random subsets tried per labelling; a cut costs as much as many
  int max_cuts = 4;         ///< per local optimisation
  int final_rounds = 6;     ///< least squares and new inliers, alternating
  int min_inliers = 12;
  double min_inlier_ratio = 0.0;
  bool graph_cut = true;  ///< false: plain RANSAC, no local optimisation, for the ablation
  std::uint64_t seed = 1;
};

template <typename Parameters>
struct RansacResult {
  Parameters model;
  bool found = false;     ///< a model exists at all; the rest is about it
  bool accepted = false;  ///< count, ratio and RMS are met
  std::vector<char> inlier;
  int num_inliers = 0;
  double rms = 0.0;    ///< of the inliers' distances
  double score = 0.0;  ///< sum of the kernels
  int samples = 0;
  int rounds = 0;
  int cuts = 0;
};

/// A Model is what is fitted, over points 0 .. size()-1:
///   struct Line {
///     struct Parameters {...};
///     static constexpr int kSampleSize = 2;                    // m
///     int size() const;
///     // From kSampleSize points; false where they are degenerate.
///     bool fit_minimal(const int* sample, Parameters& model) const;
///     // From at least kSampleSize points, by least squares; false where they are degenerate.
///     bool fit_least_squares(const std::vector<int>& points, Parameters& model) const;
///     // Squared distances of points begin .. end-1 to out[0 ..]; infinite: can be no inlier.
///     void squared_residuals(const Parameters& model, int begin, int end, double* out) const;
///   };
/// A Sampler has draw(Random&, int* sample). Nothing is allocated inside the loops but by the first
/// cut.
template <typename Model, typename Sampler>
class GraphCutRansac {
 public:
  using Parameters = typename Model::Parameters;
  using Result = RansacResult<Parameters>;

  GraphCutRansac(const Model& model, Sampler& sampler, const std::vector<NeighbourPair>& neighbours,
                 const RansacOptions& options)
      : model_(model),
        sampler_(sampler),
        neighbours_(neighbours),
        options_(options),
        random_(options.seed),
        n_(model.size()),
        pairs_{options.lambda *
                   std::min(1.0, n_ / std::max(1.0, static_cast<double>(neighbours.size()))),
               options.pairs_by_contrast},
        kernel_options_{.threshold = options.threshold, .background_cost = options.background_cost},
        kernel_(static_cast<std::size_t>(n_)),
        squared_(static_cast<std::size_t>(n_)),
        label_(static_cast<std::size_t>(n_)) {
    candidates_.reserve(kernel_.size());
    subset_.reserve(kernel_.size());
  }

  Result run() {
    Result result;
    result.inlier.assign(kernel_.size(), 0);
    if (n_ < std::max(Model::kSampleSize, options_.min_inliers)) return result;
    int stagnant = 0;
    for (result.rounds = 0; result.rounds < options_.max_rounds;) {
      const double score_before = best_score_;
      search(result);
      ++result.rounds;
      if (best_score_ > score_before) finish(result);
      if (result.accepted) break;
      stagnant = best_score_ > score_before ? 0 : stagnant + 1;
      if (stagnant >= options_.max_stagnant_rounds || result.samples >= options_.max_samples) break;
    }
    return result;
  }

 private:
  static constexpr int kBlock = 128;
  /// [D] Distance, in thresholds, up to which what the cut labels inlier is fitted to. A wider
  /// reach takes in what adjoins at the border, and the fit settles between both.
  static constexpr double kCutReach = 1.5;
  /// Growth of the support that is worth another cut.
  static constexpr double kGrowth = 1.002;
  /// Share of the score that the final least squares may cost.
  static constexpr double kScoreKept = 0.99;

  struct Support {
    double score = -1.0;
    int inliers = 0;
  };

  /// Sum of kernels and number of points within the threshold; gives up (score -1) where `to_beat`
  /// is out of reach even if all that is left fitted perfectly.
  Support support_of(const Parameters& model, double to_beat) const {
    std::array<double, kBlock> squared;
    Support support{0.0, 0};
    for (int begin = 0; begin < n_; begin += kBlock) {
      const int end = std::min(begin + kBlock, n_);
      if (support.score + (n_ - begin) <= to_beat) return {};
      model_.squared_residuals(model, begin, end, squared.data());
      const KernelSum sum = sum_kernels(squared.data(), end - begin, kernel_options_);
      support.score += sum.score;
      support.inliers += sum.inliers;
    }
    return support;
  }

  /// One inner run: minimal samples until the stopping rule says that enough were drawn.
  void search(Result& result) {
    std::array<int, Model::kSampleSize> sample;
    Parameters model;
    int needed = std::min(options_.max_inner, samples_needed());
    for (int k = 0; k < needed && result.samples < options_.max_samples; ++k) {
      ++result.samples;
      sampler_.draw(random_, sample.data());
      if (!model_.fit_minimal(sample.data(), model)) continue;
      // [D] A sample is compared with samples. Against a model that was optimised already the bare
      // sample of a better one would lose and never be optimised itself.
      Support support = support_of(model, best_sample_score_);
      if (support.score <= best_sample_score_) continue;
      best_sample_score_ = support.score;
      if (options_.graph_cut) optimise_locally(model, support, result);
      if (support.score <= best_score_) continue;
      take_best(model, support);
      needed = std::min(options_.max_inner, samples_needed());
    }
  }

  /// N = ln(1 - mu) / ln(1 - eta^m) [P].
  int samples_needed() const {
    const double eta = static_cast<double>(best_inliers_) / n_;
    const double good = std::pow(eta, Model::kSampleSize);
    if (good <= 1e-9) return options_.max_inner;
    if (good >= 1.0 - 1e-9) return 1;
    const double needed = std::log(1.0 - options_.confidence) / std::log(1.0 - good);
    return static_cast<int>(std::min(std::ceil(needed), static_cast<double>(options_.max_inner)));
  }

  void take_best(const Parameters& model, const Support& support) {
    best_ = model;
    best_score_ = support.score;
    best_inliers_ = support.inliers;
  }

  /// Cut, fit to random subsets of the cut's inliers, again while the support grows (Barath and
  /// Matas 2018, Algorithm 2).
  void optimise_locally(Parameters& best, Support& best_support, Result& result) {
    const int size = 7 * Model::kSampleSize;
    Parameters model;
    for (int cut = 0; cut < options_.max_cuts; ++cut) {
      label_by_cut(best, kCutReach, result);
      if (static_cast<int>(candidates_.size()) <= Model::kSampleSize) return;
      const double before = best_support.score;
      for (int s = 0; s < options_.subsets_per_cut; ++s) {
        draw_subset(size);
        if (!model_.fit_least_squares(subset_, model)) continue;
        const Support support = support_of(model, best_support.score);
        if (support.score > best_support.score) {
          best = model;
          best_support = support;
        }
        if (static_cast<int>(candidates_.size()) <= size) break;
      }
      if (best_support.score <= kGrowth * before) return;
    }
  }

  /// Labels all points and collects in candidates_ those labelled inlier within `reach` thresholds:
  /// the cut alone would also keep gross outliers that lie amid inliers.
  void label_by_cut(const Parameters& model, double reach, Result& result) {
    model_.squared_residuals(model, 0, n_, squared_.data());
    const double limit = reach * reach * options_.threshold * options_.threshold;
    if (options_.graph_cut) {
      ++result.cuts;
      kernels(squared_.data(), n_, kernel_options_, kernel_.data());
      cut_.label(kernel_, neighbours_, pairs_, label_);
    } else {
      std::fill(label_.begin(), label_.end(), 1);
    }
    candidates_.clear();
    for (int i = 0; i < n_; ++i) {
      if (label_[i] && squared_[i] < limit) candidates_.push_back(i);
    }
  }

  /// A random min(size, n) of the candidates, by a partial Fisher-Yates shuffle of them.
  void draw_subset(int size) {
    const int n = static_cast<int>(candidates_.size());
    size = std::min(size, n);
    subset_.clear();
    for (int i = 0; i < size; ++i) {
      std::swap(candidates_[i], candidates_[i + random_.below(n - i)]);
      subset_.push_back(candidates_[i]);
    }
  }

  /// Least squares on the inliers, repeated while the support grows; then the result's figures.
  void finish(Result& result) {
    Parameters model;
    for (int round = 0; round < options_.final_rounds; ++round) {
      label_by_cut(best_, 1.0, result);
      if (static_cast<int>(candidates_.size()) < Model::kSampleSize) break;
      if (!model_.fit_least_squares(candidates_, model)) break;
      const Support support = support_of(model, -1.0);
      const bool grows = support.score > best_score_;
      // The first is the algorithm's own last step and is taken even if the score falls a little.
      if (!grows && (round > 0 || support.score < kScoreKept * best_score_)) break;
      take_best(model, support);
      if (!grows) break;
    }
    label_by_cut(best_, 1.0, result);
    fill_result(result);
  }

  void fill_result(Result& result) const {
    result.model = best_;
    result.found = true;
    result.score = best_score_;
    result.num_inliers = static_cast<int>(candidates_.size());
    std::fill(result.inlier.begin(), result.inlier.end(), 0);
    double sum = 0.0;
    for (const int i : candidates_) {
      result.inlier[i] = 1;
      sum += squared_[i];
    }
    result.rms = candidates_.empty() ? HUGE_VAL : std::sqrt(sum / result.num_inliers);
    result.accepted = result.num_inliers >= options_.min_inliers &&
                      result.num_inliers >= options_.min_inlier_ratio * n_ &&
                      result.rms < options_.max_rms;
  }

  const Model& model_;
  Sampler& sampler_;
  const std::vector<NeighbourPair>& neighbours_;
  RansacOptions options_;
  Random random_;
  int n_;
  PairOptions pairs_;
  KernelOptions kernel_options_;
  Parameters best_{};
  double best_score_ = 0.0;
  double best_sample_score_ = 0.0;  ///< before any optimisation
  int best_inliers_ = 0;
  GraphCut cut_;
  std::vector<double> kernel_;
  std::vector<double> squared_;
  std::vector<char> label_;
  std::vector<int> candidates_;
  std::vector<int> subset_;
};

}  // namespace planecast::slam
