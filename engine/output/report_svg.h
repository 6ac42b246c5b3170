#pragma once

#include <string>

#include "engine/pipeline/reconstruction.h"

namespace planecast::engine {

/// Text as HTML or SVG content.
std::string escape_html(const std::string& text);

/// "#rrggbb" of a plane.
std::string plane_color_css(int plane_id);

/// Round number of 1, 2 or 5 times a power of ten, at most `value` > 0.
double round_below(double value);

/// Inline SVG: the map seen from above (along -up), planes as patches in their colours, points, the
/// camera's path and its first position, a scale bar. Lines and words have the page's text colour.
std::string top_view_svg(const Reconstruction& reconstruction);

}  // namespace planecast::engine
