#include "engine/look/exposure.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/look/light.h"

namespace planecast::engine {
namespace {

double linear_luminance(double r, double g, double b) {
  const auto linear = [](double v) {
    return srgb_to_linear(std::clamp(static_cast<int>(v + 0.5), 0, 255));
  };
  return 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b);
}

double pixel_luminance(const cv::Mat& image, int y, int x) {
  if (image.channels() == 1) return srgb_to_linear(image.at<std::uint8_t>(y, x));
  const cv::Vec3b bgr = image.at<cv::Vec3b>(y, x);
  return linear_luminance(bgr[2], bgr[1], bgr[0]);
}

}  // namespace

double exposure_gain(const Reconstruction& reconstruction, const cv::Mat& image,
                     const slam::Pose& world_from_cam, const ExposureOptions& options) {
  constexpr double kDark = 0.01;    // below, quantisation dominates
  constexpr double kClipped = 0.9;  // above, the sensor saturates
  const slam::Camera& camera = reconstruction.camera;
  const slam::Pose cam_from_world = world_from_cam.inverse();
  const std::size_t step = std::max<std::size_t>(
      1, reconstruction.points.size() / static_cast<std::size_t>(options.max_points));
  std::vector<double> ratios;
  for (std::size_t i = 0; i < reconstruction.points.size(); i += step) {
    const MapPoint& point = reconstruction.points[i];
    const Eigen::Vector3d p = cam_from_world * point.position;
    if (p.z() <= 0.0 || !camera.contains(camera.project(p))) continue;
    const Eigen::Vector2d raw = camera.distort(camera.project(p));
    const int x = static_cast<int>(std::lround(raw.x()));
    const int y = static_cast<int>(std::lround(raw.y()));
    if (x < 0 || y < 0 || x >= image.cols || y >= image.rows) continue;
    const double in_map =
        linear_luminance(point.color_rgb.x(), point.color_rgb.y(), point.color_rgb.z());
    const double in_frame = pixel_luminance(image, y, x);
    if (std::min(in_map, in_frame) < kDark || std::max(in_map, in_frame) > kClipped) continue;
    ratios.push_back(in_frame / in_map);
  }
  if (static_cast<int>(ratios.size()) < options.min_points) return 1.0;
  const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
  std::nth_element(ratios.begin(), middle, ratios.end());
  return std::clamp(*middle, 1.0 / options.max_gain, options.max_gain);
}

}  // namespace planecast::engine
