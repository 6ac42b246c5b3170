#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace planecast::engine {

struct DepthEdgeOptions {
  double step_share = 0.04;   ///< neighbouring depths that differ by more lie on two surfaces
  int band_px = 6;            ///< depth cameras miss an edge by up to this much
  int window_px = 9;          ///< half side of the window that votes on a pixel of the band
  double color_sigma = 12.0;  ///< grey levels: how alike pixels of one surface look
  int grid_px = 2;            ///< votes are taken on every so many-th pixel
};

/// Moves the edges of a depth image to where the picture has them, and closes the holes along them.
/// Near a jump of depth (or a hole), every pixel decides anew between the near and the far surface
/// of its window: for the one whose pixels, weighed by how much they look like it and how near they
/// are (a joint bilateral vote: Petschnigg et al. 2004), weigh more; it takes their weighted mean.
/// Elsewhere depths stay, but for a median over single wild pixels. `depth` is CV_32F metres, 0 =
/// unknown; `image` is 8-bit grey or BGR of its size; outside `regions` nothing is decided.
cv::Mat refine_depth_edges(const cv::Mat& depth, const cv::Mat& image,
                           const std::vector<cv::Rect>& regions,
                           const DepthEdgeOptions& options = {});

}  // namespace planecast::engine
