#include "engine/output/report_svg.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/evaluate/statistics.h"
#include "engine/output/palette.h"

namespace planecast::engine {
namespace {

constexpr int kTopViewSide = 640;
constexpr std::size_t kMaxDots = 4000;
constexpr double kTopViewMargin = 0.06;

/// Places the world's ground plan in the picture. Robust: what 2 % of the points lie beyond is cut
/// off.
class TopView {
 public:
  explicit TopView(const Reconstruction& reconstruction) {
    const Eigen::Vector3d up = reconstruction.up.normalized();
    // The world's z is the first camera's viewing direction: it points up on the page.
    Eigen::Vector3d ahead = Eigen::Vector3d::UnitZ() - up.z() * up;
    if (ahead.norm() < 0.1) ahead = Eigen::Vector3d::UnitX() - up.x() * up;
    ahead_ = ahead.normalized();
    right_ = ahead_.cross(up);
    if (reconstruction.camera.fy < 0.0) right_ = -right_;
    fit(reconstruction);
  }

  Eigen::Vector2d place(const Eigen::Vector3d& point) const {
    const Eigen::Vector2d flat(right_.dot(point), -ahead_.dot(point));
    return (flat - low_) * pixels_per_unit_;
  }
  std::string place_text(const Eigen::Vector3d& point) const {
    const Eigen::Vector2d placed = place(point);
    return fmt::format("{:.1f},{:.1f}", placed.x(), placed.y());
  }
  double pixels_per_unit() const { return pixels_per_unit_; }
  int height() const { return height_; }

 private:
  void fit(const Reconstruction& reconstruction) {
    std::vector<double> across;
    std::vector<double> along;
    for (const MapPoint& point : reconstruction.points) {
      across.push_back(right_.dot(point.position));
      along.push_back(-ahead_.dot(point.position));
    }
    std::sort(across.begin(), across.end());
    std::sort(along.begin(), along.end());
    low_ = {percentile_of_sorted(across, 0.02), percentile_of_sorted(along, 0.02)};
    Eigen::Vector2d high(percentile_of_sorted(across, 0.98), percentile_of_sorted(along, 0.98));
    for (const FrameRecord& frame : reconstruction.frames) {
      if (!frame.world_from_cam) continue;
      const Eigen::Vector3d position = frame.world_from_cam->translation();
      const Eigen::Vector2d flat(right_.dot(position), -ahead_.dot(position));
      low_ = low_.cwiseMin(flat);
      high = high.cwiseMax(flat);
    }
    const double extent = std::max((high - low_).maxCoeff(), 1e-6);
    low_ -= Eigen::Vector2d::Constant(kTopViewMargin * extent);
    high += Eigen::Vector2d::Constant(kTopViewMargin * extent);
    pixels_per_unit_ = kTopViewSide / (high - low_).x();
    height_ = static_cast<int>(std::ceil((high - low_).y() * pixels_per_unit_));
    if (height_ <= kTopViewSide) return;
    pixels_per_unit_ *= static_cast<double>(kTopViewSide) / height_;
    height_ = kTopViewSide;
    low_.x() -= (kTopViewSide / pixels_per_unit_ - (high - low_).x()) / 2.0;
  }

  Eigen::Vector3d right_;
  Eigen::Vector3d ahead_;
  Eigen::Vector2d low_;
  double pixels_per_unit_ = 1.0;
  int height_ = kTopViewSide;
};

std::string patches_svg(const Reconstruction& reconstruction, const TopView& view) {
  std::string svg;
  for (const PlaneRecord& plane : reconstruction.planes) {
    if (plane.polygon.size() < 3) continue;
    std::string path;
    const auto add_ring = [&](const std::vector<Eigen::Vector3d>& ring) {
      for (std::size_t i = 0; i < ring.size(); ++i) {
        path += (i == 0 ? "M" : "L") + view.place_text(ring[i]);
      }
      path += "Z";
    };
    add_ring(plane.polygon);
    for (const auto& hole : plane.holes) add_ring(hole);
    svg += fmt::format(
        "<path d=\"{0}\" fill=\"{1}\" fill-opacity=\".35\" fill-rule=\"evenodd\" stroke=\"{1}\" "
        "stroke-width=\"2\"><title>plane {2}, {3}</title></path>\n",
        path, plane_color_css(plane.id), plane.id, escape_html(plane.plane_class));
  }
  return svg;
}

std::string points_svg(const Reconstruction& reconstruction, const TopView& view) {
  std::string svg;
  const std::size_t step = reconstruction.points.size() / kMaxDots + 1;
  for (std::size_t i = 0; i < reconstruction.points.size(); i += step) {
    const MapPoint& point = reconstruction.points[i];
    const Eigen::Vector2d placed = view.place(point.position);
    if (placed.minCoeff() < 0.0 || placed.x() > kTopViewSide || placed.y() > view.height())
      continue;
    svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"1\" fill=\"{}\"/>\n", placed.x(),
                       placed.y(), plane_color_css(point.plane));
  }
  return svg;
}

/// Drawn in pieces, broken where frames have no pose.
std::string path_svg(const Reconstruction& reconstruction, const TopView& view) {
  std::string path;
  bool drawing = false;
  std::string start;
  for (const FrameRecord& frame : reconstruction.frames) {
    if (frame.world_from_cam) {
      const std::string place = view.place_text(frame.world_from_cam->translation());
      path += (drawing ? "L" : "M") + place;
      if (start.empty()) start = place;
    }
    drawing = frame.world_from_cam.has_value();
  }
  if (start.empty()) return "";
  const std::size_t comma = start.find(',');
  return fmt::format(
      "<path d=\"{}\" fill=\"none\" stroke=\"currentColor\" stroke-width=\"2\"/>\n"
      "<circle cx=\"{}\" cy=\"{}\" r=\"5\" fill=\"currentColor\"><title>start</title></circle>\n",
      path, start.substr(0, comma), start.substr(comma + 1));
}

std::string scale_bar_svg(const Reconstruction& reconstruction, const TopView& view) {
  const double length = round_below(kTopViewSide / 3.0 / view.pixels_per_unit());
  const double pixels = length * view.pixels_per_unit();
  const int y = view.height() - 12;
  return fmt::format(
      "<path d=\"M12,{0}H{1:.1f}\" stroke=\"currentColor\" stroke-width=\"3\"/>"
      "<text x=\"12\" y=\"{2}\" font-size=\"18\" fill=\"currentColor\">{3:g} {4}</text>\n",
      y, 12.0 + pixels, y - 6, length, reconstruction.metric ? "m" : "map units");
}

}  // namespace

double round_below(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {5.0, 2.0}) {
    if (step * power <= value) return step * power;
  }
  return power;
}

std::string escape_html(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::string plane_color_css(int plane_id) {
  const Rgb color = plane_color(plane_id);
  return fmt::format("#{:02x}{:02x}{:02x}", color[0], color[1], color[2]);
}

std::string top_view_svg(const Reconstruction& reconstruction) {
  const TopView view(reconstruction);
  return fmt::format("<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"top view\">\n",
                     kTopViewSide, view.height()) +
         patches_svg(reconstruction, view) + points_svg(reconstruction, view) +
         path_svg(reconstruction, view) + scale_bar_svg(reconstruction, view) + "</svg>\n";
}

}  // namespace planecast::engine
