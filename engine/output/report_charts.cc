#include "engine/output/report_charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/output/report_svg.h"

namespace planecast::engine {
namespace {

constexpr std::size_t kMaxColumns = 1200;
constexpr double kPlotHeight = 100.0;  ///< of the SVG's own units
constexpr double kTallest = 0.94;      ///< of the plot, that the highest value reaches
constexpr int kTicks = 3;
constexpr int kColors = 8;          ///< --c0 to --c7 of the style sheet
constexpr double kCutShare = 0.98;  ///< of the columns lie below the top of the chart of times

struct Column {
  std::size_t begin = 0;  ///< frames of it
  std::size_t end = 0;
};

std::vector<Column> columns_of(std::size_t frames) {
  const std::size_t count = std::min(frames, kMaxColumns);
  std::vector<Column> columns;
  for (std::size_t c = 0; c < count; ++c) {
    columns.push_back({c * frames / count, (c + 1) * frames / count});
  }
  return columns;
}

std::string svg_open(std::size_t columns, const char* label) {
  return fmt::format(
      "<svg viewBox=\"0 0 {} {:g}\" preserveAspectRatio=\"none\" role=\"img\" "
      "aria-label=\"{}\">",
      std::max<std::size_t>(columns, 1), kPlotHeight, label);
}

/// Lines and numbers at round values; the numbers are HTML over the picture.
struct Grid {
  std::string lines;
  std::string words;
};

Grid grid(double highest, std::size_t columns, const char* unit) {
  Grid result;
  const double step = round_below(std::max(highest / kTicks, 1e-9));
  for (double value = step; value <= highest / kTallest; value += step) {
    const double height = kTallest * value / highest;
    result.lines += fmt::format("<path class=\"grid\" d=\"M0,{:.2f}H{}\"/>",
                                kPlotHeight * (1.0 - height), columns);
    result.words += fmt::format("<span class=\"tick\" style=\"bottom:{:.2f}%\">{:g}{}</span>",
                                100.0 * height, value, unit);
  }
  return result;
}

double y_of(double value, double highest) {
  return kPlotHeight * (1.0 - kTallest * std::min(value / highest, 1.0 / kTallest));
}

std::string axis_html(const Reconstruction& reconstruction) {
  const int first = reconstruction.frames.front().index;
  const int last = reconstruction.frames.back().index;
  return fmt::format(
      "<div class=\"axis\"><span>frame {}</span><span>{}</span><span>{}</span></div>", first,
      first + (last - first) / 2, last);
}

/// Steps rather than slopes: a frame has a value, and between frames there is nothing.
std::string step_line(const std::vector<double>& values, double highest) {
  std::string path;
  for (std::size_t c = 0; c < values.size(); ++c) {
    path += fmt::format("{}{:.2f}H{}", c == 0 ? "M0," : "V", y_of(values[c], highest), c + 1);
  }
  return path;
}

bool same_kind(const FrameRecord& a, const FrameRecord& b) {
  return a.state == b.state && a.reason == b.reason;
}

/// One rectangle for each run of frames of the same state and reason.
std::string lane_html(const std::vector<FrameRecord>& frames) {
  std::string html = fmt::format(
      "<div class=\"lane\" data-cursor><svg viewBox=\"0 0 {} 1\" preserveAspectRatio=\"none\" "
      "role=\"img\" aria-label=\"state of each frame\">",
      frames.size());
  for (std::size_t begin = 0; begin < frames.size();) {
    std::size_t end = begin + 1;
    while (end < frames.size() && same_kind(frames[begin], frames[end])) ++end;
    const FrameRecord& frame = frames[begin];
    html += fmt::format(
        "<rect class=\"s-{}\" x=\"{}\" width=\"{}\" height=\"1\"><title>frames {} to {}: {}{}{}"
        "</title></rect>",
        escape_html(frame.state), begin, end - begin, frame.index, frames[end - 1].index,
        escape_html(frame.state), frame.reason.empty() ? "" : ", ", escape_html(frame.reason));
    begin = end;
  }
  return html + "</svg></div>";
}

/// Stage names in order of first appearance, and each one's milliseconds by column.
struct StackedTimes {
  std::vector<std::string> names;
  std::vector<std::vector<double>> columns;  ///< by column, then by name
  double highest = 0.0;                      ///< of the sums, but for the few highest

  void add(const StageTimes& times) {
    for (const auto& [name, ms] : times) {
      if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
  }
  std::size_t index(const std::string& name) const {
    return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
  }
};

StageTimes times_of(const Reconstruction& reconstruction,
                    const std::map<int, StageTimes>& render_times, std::size_t i) {
  StageTimes times;
  if (i < reconstruction.frame_times.size()) times = reconstruction.frame_times[i];
  const auto rendered = render_times.find(reconstruction.frames[i].index);
  if (rendered == render_times.end()) return times;
  for (const auto& [name, ms] : rendered->second) times.emplace_back("render: " + name, ms);
  return times;
}

double sum_of(const StageTimes& times) {
  double sum = 0.0;
  for (const auto& [name, ms] : times) sum += ms;
  return sum;
}

StackedTimes stack(const Reconstruction& reconstruction,
                   const std::map<int, StageTimes>& render_times) {
  const std::size_t frames = reconstruction.frames.size();
  StackedTimes stacked;
  // Tracking's stages first, though its first frames may have none.
  for (const StageTimes& times : reconstruction.frame_times) stacked.add(times);
  for (std::size_t i = 0; i < frames; ++i) stacked.add(times_of(reconstruction, render_times, i));
  std::vector<double> sums;
  for (const Column& column : columns_of(frames)) {
    StageTimes slowest;
    for (std::size_t i = column.begin; i < column.end; ++i) {
      StageTimes times = times_of(reconstruction, render_times, i);
      if (slowest.empty() || sum_of(times) > sum_of(slowest)) slowest = std::move(times);
    }
    std::vector<double>& values = stacked.columns.emplace_back(stacked.names.size(), 0.0);
    for (const auto& [name, ms] : slowest) values[stacked.index(name)] += ms;
    sums.push_back(sum_of(slowest));
  }
  std::ranges::sort(sums);
  const auto last = static_cast<std::size_t>(kCutShare * static_cast<double>(sums.size()));
  if (!sums.empty()) stacked.highest = sums[std::min(last, sums.size() - 1)];
  return stacked;
}

std::string area(const StackedTimes& stacked, std::size_t name) {
  const auto level = [&](std::size_t column, std::size_t names) {
    double sum = 0.0;
    for (std::size_t n = 0; n < names; ++n) sum += stacked.columns[column][n];
    return y_of(sum, stacked.highest);
  };
  const std::size_t count = stacked.columns.size();
  std::string path;
  for (std::size_t c = 0; c < count; ++c) {
    path += fmt::format("{}{:.2f}H{}", c == 0 ? "M0," : "V", level(c, name + 1), c + 1);
  }
  for (std::size_t c = count; c-- > 0;) path += fmt::format("V{:.2f}H{}", level(c, name), c);
  return fmt::format("<path class=\"c{}\" d=\"{}Z\"/>", name % kColors, path);
}

}  // namespace

std::string inlier_chart_html(const Reconstruction& reconstruction) {
  const std::vector<FrameRecord>& frames = reconstruction.frames;
  if (frames.empty()) return "";
  std::vector<double> fewest;
  for (const Column& column : columns_of(frames.size())) {
    int least = frames[column.begin].inliers;
    for (std::size_t i = column.begin; i < column.end; ++i) {
      least = std::min(least, frames[i].inliers);
    }
    fewest.push_back(least);
  }
  const double highest = std::max(1.0, *std::ranges::max_element(fewest));
  const Grid lines = grid(highest, fewest.size(), "");
  const std::string line = step_line(fewest, highest);
  return fmt::format(
      "<figure class=\"chart\" id=\"chart-inliers\"><div class=\"plot\" data-cursor>{0}{1}"
      "<path class=\"area\" d=\"{2}V{3:g}H0Z\"/><path class=\"line\" d=\"{2}\"/></svg>{4}</div>"
      "{5}{6}</figure>\n",
      svg_open(fewest.size(), "inliers by frame"), lines.lines, line, kPlotHeight, lines.words,
      lane_html(frames), axis_html(reconstruction));
}

std::string state_legend_html(const Reconstruction& reconstruction) {
  std::map<std::string, std::map<std::string, int>> counts;
  for (const FrameRecord& frame : reconstruction.frames) ++counts[frame.state][frame.reason];
  std::string html;
  for (const auto& [state, reasons] : counts) {
    int sum = 0;
    std::string why;
    for (const auto& [reason, count] : reasons) {
      sum += count;
      if (reason.empty()) continue;
      why += fmt::format("{}{} {}", why.empty() ? "" : ", ", count, escape_html(reason));
    }
    html += fmt::format("<li><i class=\"s-{0}\"></i>{0}: {1}{2}</li>", escape_html(state), sum,
                        why.empty() ? "" : " <small>(" + why + ")</small>");
  }
  return html.empty() ? html : "<ul class=\"legend\">" + html + "</ul>\n";
}

std::string times_chart_html(const Reconstruction& reconstruction,
                             const std::map<int, StageTimes>& render_times) {
  if (reconstruction.frames.empty()) return "";
  const StackedTimes stacked = stack(reconstruction, render_times);
  if (stacked.names.empty() || stacked.highest <= 0.0) return "";
  const Grid lines = grid(stacked.highest, stacked.columns.size(), " ms");
  std::string areas;
  std::string legend;
  for (std::size_t name = 0; name < stacked.names.size(); ++name) {
    areas += area(stacked, name);
    legend += fmt::format("<li><i class=\"c{}\"></i>{}</li>", name % kColors,
                          escape_html(stacked.names[name]));
  }
  return fmt::format(
      "<figure class=\"chart\" id=\"chart-times\"><div class=\"plot\" data-cursor>{}{}{}</svg>{}"
      "</div>{}</figure>\n<ul class=\"legend\">{}</ul>\n",
      svg_open(stacked.columns.size(), "milliseconds by frame"), areas, lines.lines, lines.words,
      axis_html(reconstruction), legend);
}

}  // namespace planecast::engine
