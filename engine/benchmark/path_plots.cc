#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "engine/benchmark/result_plots.h"
#include "engine/benchmark/svg.h"
#include "engine/evaluate/trajectory.h"
#include "engine/sequence/groundtruth.h"
#include "engine/user_error.h"

namespace planecast::engine {
namespace {

constexpr const char* kTruthColor = "#999";
constexpr double kPanel = 230.0;
constexpr double kTitle = 22.0;
constexpr double kMargin = 16.0;
constexpr int kPerRow = 4;

/// Axes of the picture: the two directions in which the true path extends most.
Eigen::Matrix<double, 2, 3> picture_axes(const std::vector<Eigen::Vector3d>& points,
                                         const Eigen::Vector3d& middle) {
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& point : points) {
    covariance += (point - middle) * (point - middle).transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  Eigen::Matrix<double, 2, 3> axes;
  axes.row(0) = solver.eigenvectors().col(2).transpose();
  axes.row(1) = solver.eigenvectors().col(1).transpose();
  // Eigenvectors have no sign of their own: the largest component is made positive.
  for (int i = 0; i < 2; ++i) {
    int largest = 0;
    axes.row(i).cwiseAbs().maxCoeff(&largest);
    if (axes(i, largest) < 0.0) axes.row(i) *= -1.0;
  }
  return axes;
}

Eigen::Vector3d mean_of(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points) mean += point;
  return mean / static_cast<double>(points.size());
}

/// The largest of 1, 2, 5 times a power of ten that is at most `value`.
double round_length(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {5.0, 2.0}) {
    if (step * power <= value) return step * power;
  }
  return power;
}

void draw_panel(Svg& svg, const PathPanel& panel, double left, double top) {
  const Eigen::Vector3d middle = mean_of(panel.truth);
  const Eigen::Matrix<double, 2, 3> axes = picture_axes(panel.truth, middle);
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e9);
  Eigen::Vector2d high = Eigen::Vector2d::Constant(-1e9);
  for (const Eigen::Vector3d& point : panel.truth) {
    const Eigen::Vector2d flat = axes * (point - middle);
    low = low.cwiseMin(flat);
    high = high.cwiseMax(flat);
  }
  const double extent = std::max((high - low).maxCoeff(), 1e-6);
  const double scale = (kPanel - 2.0 * kMargin - kTitle) / extent;
  const Eigen::Vector2d centre = 0.5 * (low + high);
  const auto place = [&](const Eigen::Vector3d& point) {
    const Eigen::Vector2d flat = axes * (point - middle) - centre;
    // What leaves the panel is held at its border.
    const double reach = 0.5 * kPanel - 4.0;
    return std::pair{left + 0.5 * kPanel + std::clamp(scale * flat.x(), -reach, reach),
                     top + kTitle + 0.5 * (kPanel - kTitle) -
                         std::clamp(scale * flat.y(), -reach + 0.5 * kTitle, reach - 0.5 * kTitle)};
  };
  Svg::Points truth;
  Svg::Points estimate;
  for (const Eigen::Vector3d& point : panel.truth) truth.push_back(place(point));
  for (const Eigen::Vector3d& point : panel.estimate) estimate.push_back(place(point));
  svg.text(left + 6.0, top + 15.0, panel.title);
  svg.polyline(truth, kTruthColor, 3.0);
  svg.polyline(estimate, series_color(0), 1.2);
  if (!truth.empty()) svg.dot(truth.front().first, truth.front().second, 3.0, "#222");
  const double bar = round_length(0.4 * extent);
  svg.line(left + 8.0, top + kPanel - 8.0, left + 8.0 + scale * bar, top + kPanel - 8.0, "#222",
           2.0);
  svg.text(left + 8.0, top + kPanel - 13.0, fmt::format("{:g} m", bar), Svg::Anchor::kStart, 10.0);
}

}  // namespace

std::vector<PathPanel> path_panels(const BenchmarkConfig& config,
                                   const std::vector<ResultGroup>& groups,
                                   BenchmarkRunner& runner) {
  std::vector<PathPanel> panels;
  for (const ResultGroup& group : groups) {
    const BenchmarkRow& row = *group.rows.front();
    if (group.variant != &config.variants.front() || !row.usable()) continue;
    const SequenceTruth* truth = runner.truth_of(*group.sequence);
    if (truth == nullptr) continue;
    TrajectoryOptions options;
    options.align = group.mode == "rgbd" ? Alignment::kSe3 : Alignment::kSim3;
    const std::vector<TimedPose> poses = read_trajectory(row.run.folder / "trajectory.txt");
    const auto result = evaluate_trajectory(poses, truth->poses, options);
    if (!result) continue;
    PathPanel panel;
    panel.title =
        fmt::format("{} {}: {:.1f} cm", group.sequence->name, group.mode, 100.0 * result->ate.rms);
    for (const TimedPose& pose : truth->poses) {
      panel.truth.push_back(pose.world_from_cam.translation());
    }
    for (const TimedPose& pose : poses) {
      panel.estimate.push_back(result->truth_from_estimate * pose.world_from_cam.translation());
    }
    panels.push_back(std::move(panel));
  }
  return panels;
}

std::string paths_svg(const std::vector<PathPanel>& panels) {
  if (panels.empty()) return "";
  const int count = static_cast<int>(panels.size());
  const int columns = std::min(count, kPerRow);
  const int rows = (count + columns - 1) / columns;
  Svg svg(kPanel * columns, kPanel * rows + 26.0);
  for (int i = 0; i < count; ++i) {
    draw_panel(svg, panels[static_cast<std::size_t>(i)], kPanel * (i % columns),
               kPanel * (i / columns));
  }
  const double y = kPanel * rows + 16.0;
  svg.line(10.0, y - 4.0, 34.0, y - 4.0, kTruthColor, 3.0);
  svg.text(40.0, y, "truth");
  svg.line(90.0, y - 4.0, 114.0, y - 4.0, series_color(0), 1.2);
  svg.text(120.0, y, "estimate");
  return svg.str();
}

}  // namespace planecast::engine
