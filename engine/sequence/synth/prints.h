#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

namespace planecast::engine::synth {

enum class PrintKind {
  kShapes,     ///< geometric poster: circles, bars and a title
  kMountains,  ///< layered landscape under a low sun
  kBlocks,     ///< a grid of coloured fields with black lines
  kBotanical,  ///< leaves on paper
  kMagazine,   ///< headline, picture and columns of text
  kPage,       ///< text only
  kCover,      ///< a book's front
  kMap,        ///< contour lines, roads and names
};

/// Draws a print of our own making as 8-bit BGR; the same for the same arguments.
cv::Mat draw_print(PrintKind kind, int width_px, int height_px, std::uint64_t seed);

/// A book's back seen upright: `height_px` long, with its title along it.
cv::Mat draw_spine(int width_px, int height_px, std::uint64_t seed);

/// What a window shows: sky, trees out of focus, white frame with `columns` x `rows` panes.
cv::Mat draw_window(int width_px, int height_px, int columns, int rows, std::uint64_t seed);

}  // namespace planecast::engine::synth
