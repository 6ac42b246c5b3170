#include "engine/look/debug_overlay.h"

#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "engine/output/palette.h"

namespace planecast::engine {
namespace {

constexpr int kPiecesPerEdge =
    12;  ///< so that edges bend with the lens and can be cut at the camera

cv::Scalar plane_scalar(int id) {
  const Rgb rgb = plane_color(id);
  return {static_cast<double>(rgb[2]), static_cast<double>(rgb[1]), static_cast<double>(rgb[0])};
}

void draw_text(const std::string& text, cv::Point at, const cv::Scalar& color, cv::Mat& picture) {
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.5, cv::Scalar(0, 0, 0), 3,
              cv::LINE_AA);
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.5, color, 1, cv::LINE_AA);
}

/// Raw pixel of a world point, or nothing behind the camera or far outside the picture.
std::optional<cv::Point> project(const slam::Camera& camera, const slam::Pose& cam_from_world,
                                 const Eigen::Vector3d& point) {
  const Eigen::Vector3d p = cam_from_world * point;
  if (p.z() < 1e-3) return std::nullopt;
  const Eigen::Vector2d pixel = camera.project(p);
  if (!camera.contains(pixel, -0.5 * camera.width)) return std::nullopt;
  const Eigen::Vector2d raw = camera.distort(pixel);
  return cv::Point(static_cast<int>(raw.x()), static_cast<int>(raw.y()));
}

void draw_ring(const slam::Camera& camera, const slam::Pose& cam_from_world,
               const std::vector<Eigen::Vector3d>& ring, const cv::Scalar& color,
               cv::Mat& picture) {
  for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
    std::optional<cv::Point> last;
    for (int piece = 0; piece <= kPiecesPerEdge; ++piece) {
      const double t = static_cast<double>(piece) / kPiecesPerEdge;
      const auto pixel = project(camera, cam_from_world, (1.0 - t) * ring[j] + t * ring[i]);
      if (pixel && last) cv::line(picture, *last, *pixel, color, 2, cv::LINE_AA);
      last = pixel;
    }
  }
}

}  // namespace

void draw_debug_overlay(const Reconstruction& reconstruction, const FrameRecord& frame, bool causal,
                        cv::Mat& picture) {
  const auto& pose = causal ? frame.causal_world_from_cam : frame.world_from_cam;
  if (pose) {
    const slam::Pose cam_from_world = pose->inverse();
    for (const PlaneRecord& plane : reconstruction.planes) {
      const cv::Scalar color = plane_scalar(plane.id);
      draw_ring(reconstruction.camera, cam_from_world, plane.polygon, color, picture);
      for (const auto& hole : plane.holes) {
        draw_ring(reconstruction.camera, cam_from_world, hole, color, picture);
      }
      Eigen::Vector3d centre = Eigen::Vector3d::Zero();
      for (const Eigen::Vector3d& corner : plane.polygon) centre += corner;
      if (plane.polygon.empty()) continue;
      centre /= static_cast<double>(plane.polygon.size());
      if (const auto at = project(reconstruction.camera, cam_from_world, centre)) {
        draw_text(std::to_string(plane.id) + " " + plane.plane_class, *at, color, picture);
      }
    }
  }
  draw_text("frame " + std::to_string(frame.index) + "  " + frame.state + "  " +
                std::to_string(frame.inliers) + " inliers",
            {8, picture.rows - 10}, cv::Scalar(255, 255, 255), picture);
}

}  // namespace planecast::engine
