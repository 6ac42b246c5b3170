#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <utility>
#include <vector>

#include "engine/golden/suite.h"
#include "engine/pipeline/track_sequence.h"

namespace planecast::engine {

/// Frame numbers and BGR pictures, in the case's order.
using GoldenPictures = std::vector<std::pair<int, cv::Mat>>;

/// Makes the sequence where it is a synthetic one (kept in `cache`), tracks it where there is no
/// reconstruction, and draws the case's frames. The renderer keeps to instructions that every
/// x86-64 has, so that pictures are the same on any of them; that holds for the whole process when
/// this is the first to draw in it. Throws UserError.
GoldenPictures draw_golden_case(const GoldenCase& golden_case, const std::filesystem::path& cache,
                                int threads, const Progress& progress);

}  // namespace planecast::engine
