#pragma once

#include <opencv2/core.hpp>

#include "engine/sequence/synth/random.h"

namespace planecast::engine::synth {

/// What cameras of many kinds make of light: exposure, blur, vignetting, white balance, contrast,
/// noise, compression. `light` is CV_32FC3, linear RGB; the picture is 8-bit BGR.
cv::Mat take_training_picture(const cv::Mat& light, Random& random);

}  // namespace planecast::engine::synth
