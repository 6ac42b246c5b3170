#pragma once

#include <string>
#include <vector>

#include "engine/benchmark/config.h"
#include "engine/benchmark/result_groups.h"
#include "engine/benchmark/runner.h"

namespace planecast::engine {

/// Bars of the median ATE by sequence and mode, one for each variant, with a whisker to the worst
/// seed. Empty where there is no ATE.
std::string ate_bars_svg(const std::vector<ResultGroup>& groups);

/// A path and its truth in the same world, metres.
struct PathPanel {
  std::string title;
  std::vector<Eigen::Vector3d> truth;
  std::vector<Eigen::Vector3d> estimate;
};

/// The first seed of the first variant of each sequence and mode with truth: the estimate aligned
/// with it.
std::vector<PathPanel> path_panels(const BenchmarkConfig& config,
                                   const std::vector<ResultGroup>& groups, BenchmarkRunner& runner);

/// A picture for each panel, seen along the direction in which the true path extends least (from
/// above, for a camera carried about). Empty where there are no panels.
std::string paths_svg(const std::vector<PathPanel>& panels);

/// One metric over another: a line for each group of sequences and mode, a point for each sequence.
std::string curve_svg(const BenchmarkCurve& curve, const std::vector<ResultGroup>& groups);

}  // namespace planecast::engine
