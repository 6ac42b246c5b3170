#pragma once

#include <string>
#include <utility>
#include <vector>

namespace planecast::engine {

/// Collects shapes of a picture in SVG, in pixels from the upper left corner, on white.
class Svg {
 public:
  enum class Anchor { kStart, kMiddle, kEnd };
  using Points = std::vector<std::pair<double, double>>;

  Svg(double width, double height) : width_(width), height_(height) {}

  void rect(double x, double y, double width, double height, const std::string& fill);
  void line(double x0, double y0, double x1, double y1, const std::string& color,
            double width = 1.0);
  void polyline(const Points& points, const std::string& color, double width = 1.5);
  void dot(double x, double y, double radius, const std::string& color);
  void text(double x, double y, const std::string& content, Anchor anchor = Anchor::kStart,
            double size = 12.0, const std::string& color = "#222");
  /// The whole file.
  std::string str() const;

 private:
  double width_;
  double height_;
  std::string body_;
};

/// A colour of the series `index`, told apart by colour-blind readers too.
std::string series_color(std::size_t index);

/// Round steps (1, 2 or 5 times a power of ten) of an axis from 0 to `most`: about `count` of them.
std::vector<double> axis_ticks(double most, int count = 5);

}  // namespace planecast::engine
