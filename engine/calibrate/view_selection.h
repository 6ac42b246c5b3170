#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "engine/calibrate/board.h"

namespace planecast::engine {

/// Chooses at most `most` views that are as different as they can be: in the board's place, size
/// and slant in the picture (farthest-point sampling from the largest one on). Ascending indices
/// into `views`.
std::vector<int> select_views(const std::vector<BoardView>& views, cv::Size image_size, int most);

/// Share of the cells of an 8x6 grid over the picture that hold at least one corner.
double corner_coverage(const std::vector<BoardView>& views, cv::Size image_size);

}  // namespace planecast::engine
