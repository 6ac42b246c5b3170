#pragma once

#include <opencv2/core.hpp>

#include "engine/pipeline/reconstruction.h"

namespace planecast::engine {

/// Draws the planes' outlines in their colours with ids and classes, and one line with the frame's
/// number and state. Outlines follow the lens.
void draw_debug_overlay(const Reconstruction& reconstruction, const FrameRecord& frame, bool causal,
                        cv::Mat& picture);

}  // namespace planecast::engine
