#include "engine/sequence/synth/training_raster.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace planecast::engine::synth {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr float kNear_m = 0.03F;

/// The part of a triangle before the camera: up to four corners.
int clip_near(const std::array<Vector3f, 3>& corners, std::array<Vector3f, 4>& out) {
  int count = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector3f& a = corners[i];
    const Vector3f& b = corners[(i + 1) % 3];
    const bool a_in = a.z() >= kNear_m;
    const bool b_in = b.z() >= kNear_m;
    if (a_in) out[static_cast<std::size_t>(count++)] = a;
    if (a_in != b_in) {
      out[static_cast<std::size_t>(count++)] = a + (b - a) * ((kNear_m - a.z()) / (b.z() - a.z()));
    }
  }
  return count;
}

/// x, y in pixels and 1/z, which is linear in them.
Vector3f project(const RasterCamera& camera, const Vector3f& p) {
  const float inverse = 1.0F / p.z();
  return {camera.fx * p.x() * inverse + camera.cx, camera.fy * p.y() * inverse + camera.cy,
          inverse};
}

void fill(const Vector3f& a, const Vector3f& b, const Vector3f& c, int index,
          const RasterCamera& camera, RasterImage& image) {
  const float area = (b.x() - a.x()) * (c.y() - a.y()) - (c.x() - a.x()) * (b.y() - a.y());
  if (std::abs(area) < 1e-9F) return;
  const auto first = [](float x) { return static_cast<int>(std::ceil(std::max(x, 0.0F))); };
  const auto last = [](float x, int end) {
    return static_cast<int>(std::floor(std::min(x, static_cast<float>(end - 1))));
  };
  const int x0 = first(std::min({a.x(), b.x(), c.x()}));
  const int x1 = last(std::max({a.x(), b.x(), c.x()}), camera.width);
  const int y0 = first(std::min({a.y(), b.y(), c.y()}));
  const int y1 = last(std::max({a.y(), b.y(), c.y()}), camera.height);
  if (x0 > x1 || y0 > y1) return;
  const float scale = 1.0F / area;
  // Shares of the corners, as x_step x + rest(y).
  const float b_x = (c.y() - a.y()) * scale;
  const float b_y = (a.x() - c.x()) * scale;
  const float c_x = (a.y() - b.y()) * scale;
  const float c_y = (b.x() - a.x()) * scale;
  const float z_x = b_x * (b.z() - a.z()) + c_x * (c.z() - a.z());
  for (int y = y0; y <= y1; ++y) {
    const float dy = static_cast<float>(y) - a.y();
    const float dx = static_cast<float>(x0) - a.x();
    float share_b = b_x * dx + b_y * dy;
    float share_c = c_x * dx + c_y * dy;
    float inverse = a.z() + share_b * (b.z() - a.z()) + share_c * (c.z() - a.z());
    const auto row = static_cast<std::size_t>(y * camera.width);
    for (int x = x0; x <= x1; ++x, share_b += b_x, share_c += c_x, inverse += z_x) {
      if (share_b < -1e-5F || share_c < -1e-5F || share_b + share_c > 1.00001F) continue;
      float& depth = image.inverse_depth[row + static_cast<std::size_t>(x)];
      if (inverse <= depth) continue;
      depth = inverse;
      image.triangle[row + static_cast<std::size_t>(x)] = index;
    }
  }
}

}  // namespace

std::vector<RasterTriangle> triangles_of(const RoomModel& model) {
  std::vector<RasterTriangle> triangles;
  for (std::size_t p = 0; p < model.patches.size(); ++p) {
    const Patch& patch = model.patches[p];
    const Vector2f cell(patch.width_m / static_cast<float>(patch.cols),
                        patch.height_m / static_cast<float>(patch.rows));
    for (int j = 0; j < patch.rows; ++j) {
      for (int i = 0; i < patch.cols; ++i) {
        const auto a = static_cast<std::size_t>(j * (patch.cols + 1) + i);
        const std::size_t d = a + static_cast<std::size_t>(patch.cols) + 1;
        const Vector2f uv =
            cell.cwiseProduct(Vector2f(static_cast<float>(i), static_cast<float>(j)));
        const auto add = [&](std::size_t second, std::size_t third, const Vector2f& uv_a,
                             const Vector2f& uv_b) {
          const auto& x = patch.positions;
          const auto& n = patch.normals;
          triangles.push_back({x[a], x[second] - x[a], x[third] - x[a], n[a], n[second] - n[a],
                               n[third] - n[a], uv, uv_a, uv_b, static_cast<int>(p)});
        };
        add(a + 1, d + 1, {cell.x(), 0.0F}, cell);
        add(d + 1, d, cell, {0.0F, cell.y()});
      }
    }
  }
  return triangles;
}

RasterImage rasterise(const std::vector<RasterTriangle>& triangles, const RasterCamera& camera) {
  RasterImage image;
  const auto pixels = static_cast<std::size_t>(camera.width * camera.height);
  image.inverse_depth.assign(pixels, 0.0F);
  image.triangle.assign(pixels, -1);
  std::array<Vector3f, 4> clipped;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const RasterTriangle& triangle = triangles[t];
    const Vector3f a = camera.cam_from_world * triangle.corner;
    const Vector3f edge_a = camera.cam_from_world.linear() * triangle.edge_a;
    const Vector3f edge_b = camera.cam_from_world.linear() * triangle.edge_b;
    const int count = clip_near({a, a + edge_a, a + edge_b}, clipped);
    if (count < 3) continue;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      clipped[i] = project(camera, clipped[i]);
    }
    fill(clipped[0], clipped[1], clipped[2], static_cast<int>(t), camera, image);
    if (count == 4) {
      fill(clipped[0], clipped[2], clipped[3], static_cast<int>(t), camera, image);
    }
  }
  return image;
}

}  // namespace planecast::engine::synth
