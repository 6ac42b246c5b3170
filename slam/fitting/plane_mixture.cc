#include "slam/fitting/plane_mixture.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace planecast::slam {

namespace {

double normal_density(double r, double sigma) {
  const double t = r / sigma;
  return std::exp(-0.5 * t * t) / (sigma * std::sqrt(2.0 * std::numbers::pi));
}

/// Chance that the point is on the plane; 0 out of reach.
double chance_on(const PlaneMixture& mixture, double r, double reach) {
  if (std::abs(r) >= reach) return 0.0;
  const double on = mixture.share * normal_density(r, mixture.sigma);
  const double off = (r > 0.0 ? mixture.before : mixture.behind) / reach;
  return on > 0.0 ? on / (on + off) : 0.0;
}

struct Expectation {
  double within = 0.0;  ///< points in reach
  double on = 0.0;
  double before = 0.0;
  double behind = 0.0;
  double square = 0.0;  ///< sum of chance r^2
};

double band_at(const PlanePoints& points, int i) {
  return points.band.empty() ? 1.0 : points.band[static_cast<std::size_t>(i)];
}

double distance_over_band(const PlanePoints& points, const PlaneEquation& plane, int i) {
  return plane.signed_distance(points.positions[static_cast<std::size_t>(i)]) / band_at(points, i);
}

/// Also writes, at the points' own places, the weights of a fit: chances over squared bands.
Expectation expect(const PlanePoints& points, const std::vector<int>& indices,
                   const PlaneMixture& mixture, double reach, std::vector<double>& weights) {
  Expectation result;
  for (const int i : indices) {
    const double r = distance_over_band(points, mixture.plane, i);
    const double chance = chance_on(mixture, r, reach);
    const double band = band_at(points, i);
    weights[static_cast<std::size_t>(i)] = chance / (band * band);
    if (std::abs(r) >= reach) continue;
    result.within += 1.0;
    result.on += chance;
    result.square += chance * r * r;
    (r > 0.0 ? result.before : result.behind) += 1.0 - chance;
  }
  return result;
}

/// The plane through the weighted points; false where they lie on a line.
bool refit(const PlanePoints& points, const std::vector<int>& indices,
           const std::vector<double>& weights, PlaneEquation& plane) {
  const auto fit = fit_plane(points.positions, indices, weights);
  if (!fit) return false;
  plane = fit->plane.normal.dot(plane.normal) < 0.0 ? fit->plane.flipped() : fit->plane;
  return true;
}

/// The other shares grow by what `behind` may not have.
void hold_behind(double most, PlaneMixture& mixture) {
  if (mixture.behind <= most) return;
  const double factor = (1.0 - most) / (mixture.share + mixture.before);
  mixture.share *= factor;
  mixture.before *= factor;
  mixture.behind = most;
}

double log_likelihood_of(const PlanePoints& points, const std::vector<int>& indices,
                         const PlaneMixture& mixture, double reach) {
  /// Of the points within reach, that either side is taken to have at least.
  constexpr double kLeastShare = 0.01;
  const double before = std::max(mixture.before, kLeastShare) / reach;
  const double behind = std::max(mixture.behind, kLeastShare) / reach;
  double sum = 0.0;
  for (const int i : indices) {
    const double r = distance_over_band(points, mixture.plane, i);
    sum += std::abs(r) < reach ? std::log(mixture.share * normal_density(r, mixture.sigma) +
                                          (r > 0.0 ? before : behind))
                               : std::log(std::min(before, behind));
  }
  return sum;
}

}  // namespace

std::optional<PlaneMixture> fit_plane_mixture(const PlanePoints& points,
                                              const std::vector<int>& indices,
                                              const PlaneEquation& start,
                                              const PlaneMixtureOptions& options) {
  // Even odds, so that neither side is favoured by the start.
  PlaneMixture mixture{start, options.max_sigma, 0.5, 0.25, 0.25, 0.0};
  std::vector<double> weights(points.positions.size(), 0.0);
  for (int k = 0; k < options.iterations; ++k) {
    const Expectation expected = expect(points, indices, mixture, options.reach, weights);
    if (expected.on < PlaneModel::kSampleSize) return std::nullopt;
    if (!refit(points, indices, weights, mixture.plane)) return std::nullopt;
    mixture.sigma =
        std::clamp(std::sqrt(expected.square / expected.on), options.min_sigma, options.max_sigma);
    mixture.share = expected.on / expected.within;
    mixture.before = expected.before / expected.within;
    mixture.behind = expected.behind / expected.within;
    hold_behind(options.max_behind, mixture);
  }
  mixture.log_likelihood = log_likelihood_of(points, indices, mixture, options.reach);
  return mixture;
}

std::optional<PlaneMixture> fit_plane_mixture(const PlanePoints& points,
                                              const std::vector<int>& indices,
                                              const std::vector<PlaneEquation>& starts,
                                              const PlaneMixtureOptions& options) {
  std::optional<PlaneMixture> best;
  for (const PlaneEquation& start : starts) {
    const auto mixture = fit_plane_mixture(points, indices, start, options);
    if (mixture && (!best || mixture->log_likelihood > best->log_likelihood)) best = mixture;
  }
  return best;
}

}  // namespace planecast::slam
