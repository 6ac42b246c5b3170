#pragma once

#include <opencv2/core.hpp>

#include "render/scene.h"

namespace planecast::engine {

/// The rendered layer as OpenCV images, on its way to the picture. Invariant: r, g, b <= a, and all
/// is zero outside `bounds`.
struct ObjectLayer {
  cv::Mat rgba;   ///< CV_8UC4 in that order, sRGB-encoded, premultiplied
  cv::Mat depth;  ///< CV_32F along z of the objects alone, 0 where there is none
  cv::Rect bounds;
};

/// Takes the pixels over without a copy: `layer` must live as long as the result.
ObjectLayer view_layer(render::Layer& layer);

/// frame = layer + (255 - a) * frame / 255, rounded to nearest in integers, inside the bounds
/// alone: the frame's other pixels keep their bytes. `frame_bgr` is CV_8UC3 of the layer's size.
void composite(const ObjectLayer& layer, cv::Mat& frame_bgr);

}  // namespace planecast::engine
