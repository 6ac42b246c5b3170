#pragma once

#include <string>

#include "engine/pipeline/reconstruction.h"

namespace planecast::engine {

/// Text as HTML or SVG content.
std::string escape_html(const std::string& text);

/// "#rrggbb" of a plane.
std::string plane_color_css(int plane_id);

/// Inline SVG: inliers over the frames, frames without a pose marked. Long runs are thinned to the
/// smallest value of each column.
std::string inlier_chart_svg(const Reconstruction& reconstruction);

/// Inline SVG: the map seen from above (along -up), planes as patches in their colours, points, the
/// camera's path and its first position, a scale bar.
std::string top_view_svg(const Reconstruction& reconstruction);

}  // namespace planecast::engine
