#pragma once

#include <Eigen/Core>
#include <array>

namespace planecast::slam {

/// Distortion model of the lens.
enum class LensModel {
  kPinhole,  ///< radial-tangential, OpenCV order (k1, k2, p1, p2, k3)
  kFisheye,  ///< Kannala-Brandt, (k1, k2, k3, k4)
};

/// Intrinsics of one camera. SLAM works in *undistorted* pixels, those of the ideal pinhole with
/// the same fx, fy, cx, cy; images and masks are in *raw* pixels, as recorded. Pixel centres are
/// integers. fy may be negative (ICL-NUIM).
struct Camera {
  LensModel lens = LensModel::kPinhole;
  int width = 0;
  int height = 0;
  double fx = 0.0;
  double fy = 0.0;
  double cx = 0.0;
  double cy = 0.0;
  std::array<double, 5> distortion = {0, 0, 0, 0, 0};
  bool guessed = false;  ///< the intrinsics are a guess and may be refined

  bool has_distortion() const;

  /// Undistorted pixel of a point in the camera frame. Domain: z > 0.
  Eigen::Vector2d project(const Eigen::Vector3d& point_cam) const {
    return {fx * point_cam.x() / point_cam.z() + cx, fy * point_cam.y() / point_cam.z() + cy};
  }
  /// Ray (x, y, 1) of an undistorted pixel.
  Eigen::Vector3d ray(const Eigen::Vector2d& pixel) const {
    return {(pixel.x() - cx) / fx, (pixel.y() - cy) / fy, 1.0};
  }
  /// Raw pixel -> undistorted pixel, by iteration; exact to 1e-6 px inside the model's valid field.
  Eigen::Vector2d undistort(const Eigen::Vector2d& raw_pixel) const;
  /// Undistorted pixel -> raw pixel.
  Eigen::Vector2d distort(const Eigen::Vector2d& pixel) const;
  /// Whether an undistorted pixel lies in the image (for undistorted bounds see Bounds below).
  bool contains(const Eigen::Vector2d& pixel, double border_px = 0.0) const {
    return pixel.x() >= border_px && pixel.y() >= border_px && pixel.x() < width - border_px &&
           pixel.y() < height - border_px;
  }
  /// The same camera for images of another size.
  Camera scaled_to(int new_width, int new_height) const;
};

/// The honest guess where no calibration is given: horizontal field of view of 60 degrees over the
/// longer side, centred, no distortion, guessed = true.
Camera guess_camera(int width, int height);

}  // namespace planecast::slam
