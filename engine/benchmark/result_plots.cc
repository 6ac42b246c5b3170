#include "engine/benchmark/result_plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/benchmark/svg.h"
#include "engine/evaluate/statistics.h"

namespace planecast::engine {
namespace {

using Anchor = Svg::Anchor;

constexpr const char* kAxisColor = "#ccc";

/// Groups of one sequence and mode stand together: a label and a bar for each variant.
struct BarBlock {
  std::string label;
  std::vector<const ResultGroup*> bars;
};

std::vector<BarBlock> bar_blocks(const std::vector<ResultGroup>& groups) {
  std::vector<BarBlock> blocks;
  for (const ResultGroup& group : groups) {
    if (group.summary("ate_cm").count == 0) continue;
    const std::string label = group.sequence->name + " " + group.mode;
    if (blocks.empty() || blocks.back().label != label) blocks.push_back({label, {}});
    blocks.back().bars.push_back(&group);
  }
  return blocks;
}

std::vector<const BenchmarkVariant*> variants_of(const std::vector<BarBlock>& blocks) {
  std::vector<const BenchmarkVariant*> variants;
  for (const BarBlock& block : blocks) {
    for (const ResultGroup* bar : block.bars) {
      if (std::find(variants.begin(), variants.end(), bar->variant) == variants.end()) {
        variants.push_back(bar->variant);
      }
    }
  }
  return variants;
}

/// A few failures must not press all other bars flat: three times the 80th percentile at most.
double bar_axis(const std::vector<BarBlock>& blocks) {
  std::vector<double> values;
  for (const BarBlock& block : blocks) {
    for (const ResultGroup* bar : block.bars) values.push_back(bar->summary("ate_cm").worst);
  }
  std::sort(values.begin(), values.end());
  return std::max(1e-6, std::min(values.back(), 3.0 * percentile_of_sorted(values, 0.8)));
}

}  // namespace

std::string ate_bars_svg(const std::vector<ResultGroup>& groups) {
  constexpr double kLeft = 190.0;
  constexpr double kPlot = 480.0;
  constexpr double kBar = 9.0;
  constexpr double kGap = 8.0;
  const std::vector<BarBlock> blocks = bar_blocks(groups);
  if (blocks.empty()) return "";
  const std::vector<const BenchmarkVariant*> variants = variants_of(blocks);
  const double most = bar_axis(blocks);
  const double scale = kPlot / most;
  const double legend = variants.size() > 1 ? 18.0 * static_cast<double>(variants.size()) : 0.0;
  double height = 48.0 + legend;
  for (const BarBlock& block : blocks)
    height += kGap + kBar * static_cast<double>(block.bars.size());
  Svg svg(kLeft + kPlot + 70.0, height);
  const double top = 26.0;
  const double bottom = height - legend - 22.0;
  svg.text(kLeft, 16.0, "ATE RMSE, cm: median over the seeds, whisker to the worst");
  for (const double tick : axis_ticks(most)) {
    const double x = kLeft + scale * tick;
    svg.line(x, top, x, bottom, kAxisColor);
    svg.text(x, bottom + 14.0, fmt::format("{:g}", tick), Anchor::kMiddle, 11.0, "#555");
  }
  double y = top + 0.5 * kGap;
  for (const BarBlock& block : blocks) {
    const double middle = y + 0.5 * kBar * static_cast<double>(block.bars.size());
    svg.text(kLeft - 8.0, middle + 4.0, block.label, Anchor::kEnd);
    for (const ResultGroup* bar : block.bars) {
      const MetricSummary ate = bar->summary("ate_cm");
      const auto series = static_cast<std::size_t>(
          std::find(variants.begin(), variants.end(), bar->variant) - variants.begin());
      const double end = kLeft + scale * std::min(ate.median, most);
      const double worst = kLeft + scale * std::min(ate.worst, most);
      svg.rect(kLeft, y, end - kLeft, kBar - 1.5, series_color(series));
      if (worst > end) svg.line(end, y + 0.5 * kBar, worst, y + 0.5 * kBar, "#222");
      svg.text(worst + 5.0, y + 0.5 * kBar + 3.5,
               fmt::format("{:.2f}{}", ate.median, ate.worst > most ? " (cut)" : ""),
               Anchor::kStart, 10.0, "#555");
      y += kBar;
    }
    y += kGap;
  }
  for (std::size_t i = 0; variants.size() > 1 && i < variants.size(); ++i) {
    const double line = height - legend + 18.0 * static_cast<double>(i) + 8.0;
    svg.rect(kLeft, line - 8.0, 12.0, 8.0, series_color(i));
    svg.text(kLeft + 18.0, line, variants[i]->name);
  }
  return svg.str();
}

namespace {

struct CurveLine {
  std::string label;
  std::vector<std::pair<double, double>> points;
};

std::vector<CurveLine> curve_lines(const BenchmarkCurve& curve,
                                   const std::vector<ResultGroup>& groups) {
  std::vector<CurveLine> lines;
  for (const ResultGroup& group : groups) {
    const MetricSummary x = group.summary(curve.x);
    const MetricSummary y = group.summary(curve.y);
    if (x.count == 0 || y.count == 0) continue;
    std::string label = group.sequence->group + " " + group.mode;
    if (group.variant->name != "default") label += ", " + group.variant->name;
    auto line = std::find_if(lines.begin(), lines.end(),
                             [&label](const CurveLine& known) { return known.label == label; });
    if (line == lines.end()) line = lines.insert(lines.end(), {label, {}});
    line->points.emplace_back(x.median, y.median);
  }
  for (CurveLine& line : lines) std::sort(line.points.begin(), line.points.end());
  return lines;
}

}  // namespace

std::string curve_svg(const BenchmarkCurve& curve, const std::vector<ResultGroup>& groups) {
  constexpr double kLeft = 60.0;
  constexpr double kTop = 30.0;
  constexpr double kWidth = 480.0;
  constexpr double kHeight = 260.0;
  const std::vector<CurveLine> lines = curve_lines(curve, groups);
  double most_x = 0.0;
  double most_y = 0.0;
  for (const CurveLine& line : lines) {
    for (const auto& [x, y] : line.points) {
      most_x = std::max(most_x, x);
      most_y = std::max(most_y, y);
    }
  }
  if (!(most_x > 0.0) || !(most_y > 0.0)) return "";
  const auto place = [&](double x, double y) {
    return std::pair{kLeft + kWidth * x / most_x, kTop + kHeight * (1.0 - y / most_y)};
  };
  Svg svg(kLeft + kWidth + 40.0, kTop + kHeight + 50.0 + 18.0 * static_cast<double>(lines.size()));
  svg.text(kLeft, 18.0, metric_info(curve.y).label + " against " + metric_info(curve.x).label);
  for (const double tick : axis_ticks(most_x)) {
    const auto [x, y] = place(tick, 0.0);
    svg.line(x, kTop, x, y, "#eee");
    svg.text(x, y + 16.0, fmt::format("{:g}", tick), Anchor::kMiddle, 11.0, "#555");
  }
  for (const double tick : axis_ticks(most_y)) {
    const auto [x, y] = place(0.0, tick);
    svg.line(x, y, x + kWidth, y, kAxisColor);
    svg.text(x - 6.0, y + 4.0, fmt::format("{:g}", tick), Anchor::kEnd, 11.0, "#555");
  }
  for (std::size_t i = 0; i < lines.size(); ++i) {
    Svg::Points points;
    for (const auto& [x, y] : lines[i].points) points.push_back(place(x, y));
    svg.polyline(points, series_color(i));
    for (const auto& [x, y] : points) svg.dot(x, y, 3.0, series_color(i));
    const double y = kTop + kHeight + 38.0 + 18.0 * static_cast<double>(i);
    svg.rect(kLeft, y - 8.0, 12.0, 8.0, series_color(i));
    svg.text(kLeft + 18.0, y, lines[i].label);
  }
  return svg.str();
}

}  // namespace planecast::engine
