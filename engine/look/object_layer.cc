#include "engine/look/object_layer.h"

#include <algorithm>
#include <cstdint>

namespace planecast::engine {
namespace {

/// x / 255 rounded to nearest, exact for 0 <= x <= 255 * 255.
int divide_by_255(int x) {
  const int shifted = x + 128;
  return (shifted + (shifted >> 8)) >> 8;
}

void blend(const cv::Vec4b& over, cv::Vec3b& under) {
  if (over[3] == 255) {
    under = {over[2], over[1], over[0]};
    return;
  }
  const int keep = 255 - over[3];
  for (int channel = 0; channel < 3; ++channel) {
    const int value = over[2 - channel] + divide_by_255(keep * under[channel]);
    under[channel] = static_cast<std::uint8_t>(std::min(value, 255));
  }
}

}  // namespace

ObjectLayer view_layer(render::Layer& layer) {
  ObjectLayer view;
  if (layer.rgba.empty()) return view;
  view.rgba = cv::Mat(layer.rgba.height, layer.rgba.width, CV_8UC4, layer.rgba.pixels.data());
  if (!layer.depth.empty()) {
    view.depth =
        cv::Mat(layer.depth.height, layer.depth.width, CV_32FC1, layer.depth.pixels.data());
  }
  const cv::Rect bounds(layer.bounds.x, layer.bounds.y, layer.bounds.width, layer.bounds.height);
  view.bounds = bounds & cv::Rect(cv::Point(), view.rgba.size());
  return view;
}

void composite(const ObjectLayer& layer, cv::Mat& frame_bgr) {
  CV_Assert(frame_bgr.type() == CV_8UC3);
  if (layer.bounds.empty()) return;
  CV_Assert(layer.rgba.size() == frame_bgr.size());
  for (int y = layer.bounds.y; y < layer.bounds.br().y; ++y) {
    const auto* over = layer.rgba.ptr<cv::Vec4b>(y);
    auto* under = frame_bgr.ptr<cv::Vec3b>(y);
    for (int x = layer.bounds.x; x < layer.bounds.br().x; ++x) {
      if (over[x][3] != 0) blend(over[x], under[x]);
    }
  }
}

}  // namespace planecast::engine
