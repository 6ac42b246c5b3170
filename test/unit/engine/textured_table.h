#pragma once

#include <opencv2/imgproc.hpp>

#include "engine/scene/plane_outline.h"
#include "picture_sequence.h"
#include "table_world.h"

namespace planecast::engine {

/// The table of table_world() filmed by a camera that looks down on it and moves: frames 0..29, all
/// with their true pose.
inline Reconstruction filmed_table() {
  Reconstruction world = table_world();
  world.frames.clear();
  for (int index = 0; index < 30; ++index) {
    FrameRecord frame;
    frame.index = index;
    frame.timestamp = index / 30.0;
    frame.state = "tracked";
    slam::Pose pose = slam::Pose::Identity();
    pose.translation() = Eigen::Vector3d(0.02 * index - 0.3, -0.3, 0.5);
    pose.rotate(Eigen::AngleAxisd(-0.7, Eigen::Vector3d::UnitX()));
    pose.rotate(Eigen::AngleAxisd(0.004 * index - 0.06, Eigen::Vector3d::UnitZ()));
    frame.world_from_cam = pose;
    frame.causal_world_from_cam = pose;
    world.frames.push_back(frame);
  }
  return world;
}

/// A picture painted on the table: its pixel (u, v) lies at `corner` + u right + v down, with
/// `pixel_m` metres a pixel, right along x and down towards the viewer (-z).
struct TablePrint {
  cv::Mat grey;
  Eigen::Vector2d corner_xz;
  double pixel_m = 0.001;

  Eigen::Vector3d at(double u, double v) const {
    return {corner_xz.x() + u * pixel_m, 0.5, corner_xz.y() - v * pixel_m};
  }
};

/// The camera's view of the print, all else grey.
inline cv::Mat film(const TablePrint& print, const slam::Camera& camera, const slam::Pose& pose) {
  std::vector<cv::Point2f> from;
  std::vector<cv::Point2f> to;
  for (const auto& [u, v] :
       {std::pair(0, 0), std::pair(print.grey.cols - 1, 0),
        std::pair(print.grey.cols - 1, print.grey.rows - 1), std::pair(0, print.grey.rows - 1)}) {
    const Eigen::Vector2d pixel = camera.project(pose.inverse() * print.at(u, v));
    from.emplace_back(static_cast<float>(u), static_cast<float>(v));
    to.emplace_back(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
  }
  // Twice the size and averaged: the print is finer than the pixels.
  for (cv::Point2f& p : to) p = {2.0F * p.x + 0.5F, 2.0F * p.y + 0.5F};
  cv::Mat view(2 * camera.height, 2 * camera.width, CV_8UC1, cv::Scalar(128));
  cv::warpPerspective(print.grey, view, cv::getPerspectiveTransform(from, to), view.size(),
                      cv::INTER_LINEAR, cv::BORDER_TRANSPARENT);
  cv::Mat half;
  cv::resize(view, half, {camera.width, camera.height}, 0, 0, cv::INTER_AREA);
  return half;
}

inline PictureSequence film_table(const Reconstruction& world, const TablePrint& print) {
  return {world.camera, 0, 30, [&world, &print](int index) {
            slam::FrameInput frame;
            frame.image = film(print, world.camera,
                               *world.frames[static_cast<std::size_t>(index)].world_from_cam);
            return frame;
          }};
}

}  // namespace planecast::engine
