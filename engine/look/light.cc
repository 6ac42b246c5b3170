#include "engine/look/light.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace planecast::engine {
namespace {

constexpr double kY0 = 0.28209479177387814;  // 1 / (2 sqrt(pi))
constexpr double kY1 = 0.48860251190291992;  // sqrt(3 / (4 pi))
/// A surface that faces up gathers two thirds of a linear gradient (Ramamoorthi and Hanrahan 2001).
constexpr double kGradientOnFacing = 2.0 / 3.0;

const std::array<double, 256>& linear_table() {
  static const std::array<double, 256> table = [] {
    std::array<double, 256> values{};
    for (int i = 0; i < 256; ++i) {
      const double v = i / 255.0;
      values[static_cast<std::size_t>(i)] =
          v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
    }
    return values;
  }();
  return table;
}

double luminance(const Eigen::Vector3d& rgb) {
  return 0.2126 * rgb.x() + 0.7152 * rgb.y() + 0.0722 * rgb.z();
}

/// Linear RGB means of a coarse grid over the picture.
cv::Mat coarse_linear(const cv::Mat& image, int cols, int rows) {
  cv::Mat table(1, 256, CV_32FC1);
  for (int i = 0; i < 256; ++i) table.at<float>(i) = static_cast<float>(srgb_to_linear(i));
  cv::Mat linear;
  cv::LUT(image, table, linear);
  cv::Mat coarse;
  cv::resize(linear, coarse, cv::Size(cols, rows), 0, 0, cv::INTER_AREA);
  return coarse;
}

Eigen::Vector3d rgb_at(const cv::Mat& linear, int y, int x) {
  if (linear.channels() == 1) return Eigen::Vector3d::Constant(linear.at<float>(y, x));
  const cv::Vec3f bgr = linear.at<cv::Vec3f>(y, x);
  return {bgr[2], bgr[1], bgr[0]};
}

Eigen::Vector3d flattened(const Eigen::Vector3d& v, const Eigen::Vector3d& normal) {
  return v - normal.dot(v) * normal;
}

}  // namespace

double srgb_to_linear(int value) { return linear_table()[static_cast<std::size_t>(value)]; }

std::array<Eigen::Vector3d, 9> SceneLight::ambient_sh(double gain) const {
  std::array<Eigen::Vector3d, 9> sh;
  sh.fill(Eigen::Vector3d::Zero());
  sh[0] = gain * mean / kY0;
  sh[1] = gain * mean * gradient.y() / kY1;
  sh[2] = gain * mean * gradient.z() / kY1;
  sh[3] = gain * mean * gradient.x() / kY1;
  return sh;
}

void LightEstimator::add(const cv::Mat& image, const slam::Camera& camera,
                         const slam::Pose& world_from_cam) {
  constexpr int kCols = 32;
  constexpr int kRows = 24;
  const cv::Mat linear = coarse_linear(image, kCols, kRows);
  const Eigen::Matrix3d rotation = world_from_cam.linear();
  for (int y = 0; y < kRows; ++y) {
    for (int x = 0; x < kCols; ++x) {
      const Eigen::Vector2d pixel((x + 0.5) * camera.width / kCols - 0.5,
                                  (y + 0.5) * camera.height / kRows - 0.5);
      const Eigen::Vector3d ray = rotation * camera.ray(camera.undistort(pixel));
      samples_.push_back({ray.normalized(), rgb_at(linear, y, x)});
    }
  }
  view_sum_ += rotation.col(2);
  right_sum_ += rotation.col(0);
}

double LightEstimator::quantile(double share) const {
  std::vector<double> values;
  for (const Sample& sample : samples_) values.push_back(luminance(sample.radiance));
  const auto nth =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

Eigen::Vector3d LightEstimator::robust_mean() const {
  // Lamps and windows in view shine; black screens and shadows reflect nothing: neither is a
  // surface.
  const double low = quantile(0.05);
  const double high = quantile(0.95);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;
  for (const Sample& sample : samples_) {
    const double value = luminance(sample.radiance);
    if (value < low || value > high) continue;
    sum += sample.radiance;
    ++count;
  }
  return sum / std::max(count, 1);
}

double LightEstimator::brightness() const {
  const double by_mean = luminance(robust_mean()) / options_.mean_albedo;
  const double by_bright = quantile(0.9) / options_.bright_albedo;
  return std::clamp(0.5 * (by_mean + by_bright), options_.min_brightness, options_.max_brightness);
}

/// Ridge regression of relative brightness on the horizontal direction.
Eigen::Vector3d LightEstimator::side_gradient(const Eigen::Vector3d& up) const {
  const double mean = std::max(luminance(robust_mean()), 1e-4);
  const double prior = 0.05 * static_cast<double>(samples_.size());  // weight of "no gradient"
  Eigen::Vector3d direction_mean = Eigen::Vector3d::Zero();
  for (const Sample& sample : samples_) direction_mean += flattened(sample.direction, up);
  direction_mean /= static_cast<double>(samples_.size());
  Eigen::Matrix3d normal = prior * Eigen::Matrix3d::Identity();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const Sample& sample : samples_) {
    const Eigen::Vector3d d = flattened(sample.direction, up) - direction_mean;
    const double relative = std::min(luminance(sample.radiance) / mean, 3.0) - 1.0;
    normal += d * d.transpose();
    right += relative * d;
  }
  const Eigen::Vector3d gradient = flattened(normal.ldlt().solve(right), up);
  constexpr double kMost = 0.4;  // a diffuse room is no more one-sided than this
  return gradient.norm() > kMost ? Eigen::Vector3d(kMost * gradient.normalized()) : gradient;
}

/// Where windows and lamps are seen: mean horizontal direction of what outshines every surface,
/// longer the more of it there is, at most 1.
Eigen::Vector3d LightEstimator::visible_sources(const Eigen::Vector3d& up) const {
  constexpr double kOutshines = 2.5;    // times the mean: beyond white paper in an average room
  constexpr double kNearlyWhite = 0.6;  // linear
  constexpr double kCertainShare = 0.02;
  const double threshold = std::max(kOutshines * luminance(robust_mean()), kNearlyWhite);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Sample& sample : samples_) {
    if (luminance(sample.radiance) > threshold) sum += flattened(sample.direction, up);
  }
  sum /= kCertainShare * static_cast<double>(samples_.size());
  return sum.norm() > 1.0 ? Eigen::Vector3d(sum.normalized()) : sum;
}

SceneLight LightEstimator::estimate(const Eigen::Vector3d& up) const {
  SceneLight light;
  light.gradient = options_.up_gradient * up;
  light.sun_direction = up;
  if (samples_.empty()) return light;
  const Eigen::Vector3d seen = robust_mean();
  const Eigen::Vector3d tint = seen / std::max(luminance(seen), 1e-4);
  const Eigen::Vector3d color =
      options_.neutral_share * Eigen::Vector3d::Ones() + (1.0 - options_.neutral_share) * tint;
  const Eigen::Vector3d side = side_gradient(up);
  light.gradient = options_.up_gradient * up + 0.5 * side;
  // Seen by the viewer, light from the upper left and a little from behind shows shapes best; what
  // the pictures say outweighs it as soon as they say anything.
  const Eigen::Vector3d custom = -0.10 * right_sum_.normalized() - 0.06 * view_sum_.normalized();
  const Eigen::Vector3d sources = visible_sources(up);
  const double seen_share = sources.norm();
  const Eigen::Vector3d lateral = flattened(custom, up) + side + 0.5 * sources;
  // A window that is seen shines flatter than a lamp on the ceiling, and throws darker shadows.
  const double lean = 0.6 * std::min(1.0, 4.0 * lateral.norm()) + 0.35 * seen_share;
  light.sun_direction = (up + lean * lateral.normalized()).normalized();
  const double facing = light.sun_direction.dot(up);
  const double sun_share = options_.sun_share + options_.source_share * seen_share;
  light.sun_radiance = color * brightness() * sun_share / std::max(facing, 0.3);
  light.mean =
      color * brightness() * (1.0 - sun_share) / (1.0 + kGradientOnFacing * options_.up_gradient);
  return light;
}

}  // namespace planecast::engine
