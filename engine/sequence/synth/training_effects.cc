#include "engine/sequence/synth/training_effects.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace planecast::engine::synth {
namespace {

void blur(cv::Mat& light, Random& random) {
  const double kind = random.uniform();
  if (kind < 0.35) {
    const double sigma = random.uniform(0.3, 1.6);
    cv::GaussianBlur(light, light, {0, 0}, sigma);
  } else if (kind < 0.55) {
    const int half = 3;
    cv::Mat kernel = cv::Mat::zeros(2 * half + 1, 2 * half + 1, CV_32F);
    const double angle = random.uniform(0.0, 3.14159265);
    const double length = random.uniform(1.0, 3.0);
    constexpr int kSteps = 24;
    for (int i = 0; i <= kSteps; ++i) {
      const double t = length * (2.0 * i / kSteps - 1.0);
      kernel.at<float>(half + static_cast<int>(std::lround(t * std::sin(angle))),
                       half + static_cast<int>(std::lround(t * std::cos(angle)))) += 1.0F;
    }
    kernel /= cv::sum(kernel)[0];
    cv::filter2D(light, light, -1, kernel, {-1, -1}, 0, cv::BORDER_REPLICATE);
  }
}

/// What the mean of the picture is brought to.
float exposure(const cv::Mat& light, Random& random) {
  cv::Mat capped;
  cv::min(light, 4.0 * (cv::mean(light)[1] + 1e-6), capped);
  const cv::Scalar mean = cv::mean(capped);
  const double level = (mean[0] + mean[1] + mean[2]) / 3.0 + 1e-6;
  return static_cast<float>(std::exp(random.uniform(std::log(0.10), std::log(0.50))) / level);
}

}  // namespace

cv::Mat take_training_picture(const cv::Mat& scene, Random& random) {
  cv::Mat light = scene.clone();
  blur(light, random);
  const float gain = exposure(light, random);
  const double vignetting = random.uniform(0.0, 0.5);
  const double gamma = 1.0 / random.uniform(1.7, 2.6);
  const double contrast = random.uniform(0.8, 1.35);
  const double saturation = random.uniform() < 0.1 ? 0.0 : random.uniform(0.6, 1.5);
  const double noise = std::pow(random.uniform(), 3.0) * 13.0;
  const double haze = random.uniform() < 0.2 ? random.uniform(0.0, 0.06) : 0.0;
  double balance[3];
  for (double& b : balance) b = gain * random.uniform(0.82, 1.18);
  cv::Mat picture(light.size(), CV_32FC3);
  const double cx = 0.5 * light.cols;
  const double cy = 0.5 * light.rows;
  for (int y = 0; y < light.rows; ++y) {
    for (int x = 0; x < light.cols; ++x) {
      const auto& in = light.at<cv::Vec3f>(y, x);
      const double r2 = ((x - cx) * (x - cx) + (y - cy) * (y - cy)) / (cx * cx + cy * cy);
      const double fall = 1.0 - vignetting * r2;
      double value[3];
      double grey = 0.0;
      for (int c = 0; c < 3; ++c) {
        const double linear = std::max(0.0, in[c] * balance[c] * fall + haze);
        // A soft shoulder instead of hard clipping.
        const double rolled = linear < 0.7 ? linear : 1.0 - 0.3 * std::exp((0.7 - linear) / 0.3);
        value[c] = 0.5 + contrast * (std::pow(rolled, gamma) - 0.5);
        grey += value[c] / 3.0;
      }
      for (int c = 0; c < 3; ++c) {
        picture.at<cv::Vec3f>(y, x)[2 - c] =
            static_cast<float>(255.0 * (grey + saturation * (value[c] - grey)));
      }
    }
  }
  if (noise > 0.3) {
    cv::Mat grain(picture.size(), CV_32FC3);
    for (int y = 0; y < grain.rows; ++y) {
      auto* row = grain.ptr<float>(y);
      // Three uniforms are near enough to a normal distribution.
      for (int x = 0; x < 3 * grain.cols; ++x) {
        const std::uint64_t bits = random.next();
        const auto sum =
            static_cast<double>((bits & 0xFFFF) + (bits >> 16 & 0xFFFF) + (bits >> 32 & 0xFFFF)) /
                65536.0 -
            1.5;
        row[x] = static_cast<float>(2.0 * noise * sum);
      }
    }
    if (random.uniform() < 0.5) cv::blur(grain, grain, {2, 2});
    picture += grain;
  }
  cv::Mat bgr;
  picture.convertTo(bgr, CV_8U);
  if (random.uniform() < 0.25) {
    std::vector<unsigned char> bytes;
    cv::imencode(".jpg", bgr, bytes, {cv::IMWRITE_JPEG_QUALITY, 40 + random.below(55)});
    bgr = cv::imdecode(bytes, cv::IMREAD_COLOR);
  }
  return bgr;
}

}  // namespace planecast::engine::synth
