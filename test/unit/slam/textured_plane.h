#pragma once

#include <Eigen/Core>
#include <cmath>
#include <opencv2/core.hpp>

#include "slam/data/camera.h"
#include "slam/data/types.h"

/// Images of a textured plane by ray casting a smooth function: exact at every pixel, so that
/// positions are known to far less than a pixel.
namespace planecast::slam::synthetic {

/// 320 x 240 pixels, without distortion and known.
inline Camera small_camera() {
  Camera camera = guess_camera(320, 240);
  camera.guessed = false;
  return camera;
}

/// Grey value, 40 to 215, at a point of the texture; its finest wave is 0.12 units long.
inline double texture(double x, double y) {
  const double coarse = std::sin(9.0 * x + 2.0 * std::sin(5.0 * y)) * std::cos(11.0 * y - 4.0 * x);
  const double fine = std::sin(38.0 * x + 17.0 * y) * std::sin(31.0 * y - 23.0 * x);
  return 127.5 + 87.5 * (0.55 * coarse + 0.45 * fine);
}

/// The plane z = `depth` of the world, seen by a camera; `gain` and `offset` change the exposure.
inline cv::Mat render_plane(const Camera& camera, const Pose& cam_from_world, double depth,
                            double gain = 1.0, double offset = 0.0) {
  cv::Mat image(camera.height, camera.width, CV_8UC1);
  const Pose world_from_cam = cam_from_world.inverse();
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) {
      const Eigen::Vector2d pixel = camera.undistort(Eigen::Vector2d(u, v));
      const Eigen::Vector3d ray = world_from_cam.linear() * camera.ray(pixel);
      const Eigen::Vector3d from = world_from_cam.translation();
      const Eigen::Vector3d hit = from + ray * ((depth - from.z()) / ray.z());
      image.at<uchar>(v, u) = cv::saturate_cast<uchar>(gain * texture(hit.x(), hit.y()) + offset);
    }
  }
  return image;
}

}  // namespace planecast::slam::synthetic
