#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "engine/sequence/sequence.h"

namespace planecast::engine {

/// "A:B" with either side left out, as after --frames. Throws UserError.
void parse_frames(const std::string& text, SequenceOptions& options);

/// "WxH" in pixels, as after --size. Throws UserError.
cv::Size parse_size(const std::string& text);

}  // namespace planecast::engine
