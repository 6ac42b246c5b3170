#pragma once

#include <optional>
#include <vector>

#include "slam/fitting/plane_model.h"

namespace planecast::slam {

struct PlaneMixtureOptions {
  double reach = 0.0;      ///< distance over band up to which points are looked at
  double min_sigma = 0.0;  ///< the sheet's deviation is not told finer than this
  double max_sigma = 0.0;  ///< where the search starts: a sheet is no thicker
  /// Of `behind`: how much of what is within reach may be seen through the plane. 1 asks nothing.
  double max_behind = 1.0;
  int iterations = 12;
};

/// A plane amid points that are not on it. The plane's normal keeps to the side of the start's.
struct PlaneMixture {
  PlaneEquation plane;
  double sigma = 0.0;   ///< of distance over band of the points on the plane
  double share = 0.0;   ///< of the points within reach that are on the plane
  double before = 0.0;  ///< share on the normal's side that is not: things that stand before it
  double behind = 0.0;  ///< share on the other side; an opaque plane has nothing but strays there
  double log_likelihood = 0.0;  ///< of all points; those out of reach as the rarest within it
};

/// Expectation maximisation of
///   p(r) = share N(r; 0, sigma) + before U(0, reach) + behind U(-reach, 0),   r = distance / band
/// (the mixture of Torr and Zisserman's MLESAC, 2000, with an outlier density of each side's own
/// [D]) over `indices`, from the plane `start`. Least squares goes to the middle of a table's board
/// and the things on it, as does any loss that is even in r; here what stands before the plane is
/// told from what is on it by its density. Nothing where the points are fewer than three, on a line
/// or all out of reach.
std::optional<PlaneMixture> fit_plane_mixture(const PlanePoints& points,
                                              const std::vector<int>& indices,
                                              const PlaneEquation& start,
                                              const PlaneMixtureOptions& options);

/// The likeliest of the mixtures from several starts: each finds but the nearest maximum, and a
/// crowd of things at one end can hold a plane tilted.
std::optional<PlaneMixture> fit_plane_mixture(const PlanePoints& points,
                                              const std::vector<int>& indices,
                                              const std::vector<PlaneEquation>& starts,
                                              const PlaneMixtureOptions& options);

}  // namespace planecast::slam
