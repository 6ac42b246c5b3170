#include "engine/benchmark/svg.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "engine/output/report_svg.h"

namespace planecast::engine {

void Svg::rect(double x, double y, double width, double height, const std::string& fill) {
  body_ += fmt::format(
      "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" "
      "fill=\"{}\"/>\n",
      x, y, width, height, fill);
}

void Svg::line(double x0, double y0, double x1, double y1, const std::string& color, double width) {
  body_ += fmt::format(
      "<path d=\"M{:.1f},{:.1f}L{:.1f},{:.1f}\" stroke=\"{}\" "
      "stroke-width=\"{:g}\"/>\n",
      x0, y0, x1, y1, color, width);
}

void Svg::polyline(const Points& points, const std::string& color, double width) {
  if (points.empty()) return;
  body_ += "<path d=\"";
  char step = 'M';
  for (const auto& [x, y] : points) {
    body_ += fmt::format("{}{:.1f},{:.1f}", step, x, y);
    step = 'L';
  }
  body_ += fmt::format(
      "\" fill=\"none\" stroke=\"{}\" stroke-width=\"{:g}\" "
      "stroke-linejoin=\"round\"/>\n",
      color, width);
}

void Svg::dot(double x, double y, double radius, const std::string& color) {
  body_ += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:g}\" fill=\"{}\"/>\n", x, y,
                       radius, color);
}

void Svg::text(double x, double y, const std::string& content, Anchor anchor, double size,
               const std::string& color) {
  constexpr std::array<const char*, 3> kAnchors = {"start", "middle", "end"};
  body_ += fmt::format(
      "<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"{:g}\" text-anchor=\"{}\" "
      "fill=\"{}\">{}</text>\n",
      x, y, size, kAnchors[static_cast<std::size_t>(anchor)], color, escape_html(content));
}

std::string Svg::str() const {
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:g} {1:g}\" "
      "width=\"{0:g}\" height=\"{1:g}\" font-family=\"system-ui,sans-serif\">\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n{2}</svg>\n",
      width_, height_, body_);
}

std::string series_color(std::size_t index) {
  constexpr std::array<const char*, 7> kColors = {"#1668b8", "#d1603d", "#3f8f5f", "#8a63a8",
                                                  "#b8912a", "#4aa3a8", "#7a6a5b"};
  return kColors[index % kColors.size()];
}

std::vector<double> axis_ticks(double most, int count) {
  if (!(most > 0.0)) return {0.0};
  const double raw = most / count;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  double step = 10.0 * power;
  for (const double nice : {5.0, 2.0, 1.0}) {
    if (nice * power >= raw * (1.0 - 1e-9)) step = nice * power;
  }
  std::vector<double> ticks;
  for (int i = 0; i * step <= most * (1.0 + 1e-9); ++i) ticks.push_back(i * step);
  return ticks;
}

}  // namespace planecast::engine
