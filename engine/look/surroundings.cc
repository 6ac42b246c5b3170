#include "engine/look/surroundings.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "engine/convert.h"
#include "render/environment.h"

namespace planecast::engine {
namespace {

cv::Mat linear_rgb(const cv::Mat& image) {
  cv::Mat rgb;
  cv::cvtColor(image, rgb, image.channels() == 1 ? cv::COLOR_GRAY2RGB : cv::COLOR_BGR2RGB);
  cv::Mat table(1, 256, CV_32FC1);
  for (int i = 0; i < 256; ++i) table.at<float>(i) = static_cast<float>(srgb_to_linear(i));
  cv::Mat linear;
  cv::LUT(rgb, table, linear);
  return linear;
}

Eigen::Vector3d direction_of(int x, int y, const cv::Size& size) {
  const glm::vec3 d = render::equirectangular_direction(
      {(static_cast<float>(x) + 0.5F) / static_cast<float>(size.width),
       (static_cast<float>(y) + 0.5F) / static_cast<float>(size.height)});
  return Eigen::Vector3d(d.x, d.y, d.z);
}

cv::Vec3f radiance(const SceneLight& light, const Eigen::Vector3d& direction) {
  const Eigen::Vector3d rgb = light.mean * std::max(1.0 + light.gradient.dot(direction), 0.0);
  return {static_cast<float>(rgb.x()), static_cast<float>(rgb.y()), static_cast<float>(rgb.z())};
}

float row_weight(int y, int height) {
  return static_cast<float>(std::sin(std::numbers::pi * (y + 0.5) / height));
}

}  // namespace

Surroundings::Surroundings(const SurroundingsOptions& options)
    : options_(options),
      sum_(options.height, 2 * options.height, CV_32FC3, cv::Scalar::all(0.0)),
      weight_(options.height, 2 * options.height, CV_32FC1, cv::Scalar(0.0)) {}

void Surroundings::add(const cv::Mat& image, const slam::Camera& camera,
                       const slam::Pose& world_from_cam, double gain) {
  // Averaged to about the panorama's own resolution first.
  const double texel = std::numbers::pi / options_.height;
  const double pixels = std::max(1.0, 0.5 * texel * camera.fx);
  cv::Mat small;
  cv::resize(linear_rgb(image), small, {}, 1.0 / pixels, 1.0 / pixels, cv::INTER_AREA);
  const Eigen::Matrix3d cam_from_world = world_from_cam.linear().transpose();
  for (int y = 0; y < sum_.rows; ++y) {
    for (int x = 0; x < sum_.cols; ++x) {
      const Eigen::Vector3d d = cam_from_world * direction_of(x, y, sum_.size());
      if (d.z() < 0.1) continue;
      const Eigen::Vector2d pixel = camera.project(d);
      const int u = static_cast<int>(std::floor((pixel.x() + 0.5) * small.cols / image.cols));
      const int v = static_cast<int>(std::floor((pixel.y() + 0.5) * small.rows / image.rows));
      if (u < 0 || v < 0 || u >= small.cols || v >= small.rows) continue;
      sum_.at<cv::Vec3f>(y, x) += small.at<cv::Vec3f>(v, u) * static_cast<float>(1.0 / gain);
      weight_.at<float>(y, x) += 1.0F;
    }
  }
}

double Surroundings::seen() const {
  double seen = 0.0;
  double all = 0.0;
  for (int y = 0; y < weight_.rows; ++y) {
    const double row = row_weight(y, weight_.rows);
    for (int x = 0; x < weight_.cols; ++x) seen += weight_.at<float>(y, x) > 0.0F ? row : 0.0;
    all += row * weight_.cols;
  }
  return seen / all;
}

render::ImageF Surroundings::panorama(const SceneLight& light) const {
  cv::Mat known;
  cv::compare(weight_, 0.0, known, cv::CMP_GT);
  // Inside what was seen, how far it is to where nothing was.
  cv::Mat inside;
  cv::distanceTransform(known, inside, cv::DIST_L2, cv::DIST_MASK_5);
  render::ImageF map(sum_.cols, sum_.rows, 3);
  float* out = map.pixels.data();
  for (int y = 0; y < sum_.rows; ++y) {
    for (int x = 0; x < sum_.cols; ++x, out += 3) {
      const float weight = weight_.at<float>(y, x);
      const float share =
          std::min(1.0F, inside.at<float>(y, x) / static_cast<float>(options_.blend_texels));
      const cv::Vec3f guessed = radiance(light, direction_of(x, y, sum_.size()));
      const cv::Vec3f found =
          weight > 0.0F ? cv::Vec3f(sum_.at<cv::Vec3f>(y, x) * (1.0F / weight)) : guessed;
      for (int c = 0; c < 3; ++c) out[c] = guessed[c] + share * (found[c] - guessed[c]);
    }
  }
  return map;
}

}  // namespace planecast::engine
