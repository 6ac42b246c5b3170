#pragma once

#include <map>
#include <string>

#include "engine/pipeline/reconstruction.h"

namespace planecast::engine {

/// Charts by frame as HTML with inline SVG. The plot stretches to the page's width while lines and
/// words keep their size, so that they are readable on a phone and without scripts. Long runs are
/// thinned to 1,200 columns.

/// Inliers of each frame (of a column the fewest) over a lane with the frames' states.
std::string inlier_chart_html(const Reconstruction& reconstruction);

/// Frames by state, and by the reason why they were not tracked, as a legend of the lane.
std::string state_legend_html(const Reconstruction& reconstruction);

/// Milliseconds of each frame (of a column the slowest), stages stacked: the stages of tracking,
/// then those of rendering. Empty without times.
std::string times_chart_html(const Reconstruction& reconstruction,
                             const std::map<int, StageTimes>& render_times);

}  // namespace planecast::engine
