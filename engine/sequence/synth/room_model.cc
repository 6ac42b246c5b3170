#include "engine/sequence/synth/room_model.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace planecast::engine::synth {

namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kTwoPi = 2.0 * std::numbers::pi;

std::string class_of(const Vector3d& normal) {
  if (std::abs(normal.z()) > 0.99) return "horizontal";
  return std::abs(normal.z()) < 0.01 ? "vertical" : "other";
}

/// To whole micrometres (2^-20 m): sums of such numbers are exact also as floats within 16 m, so
/// that faces which share an edge leave no crack between them.
Vector3d snap(const Vector3d& v) { return (v * 0x1.0p20).array().rint() * 0x1.0p-20; }

Vector3f interpolate(const Patch& patch, const std::vector<Vector3f>& values, float u, float v) {
  const float x = std::clamp(u, 0.0F, 1.0F) * static_cast<float>(patch.cols);
  const float y = std::clamp(v, 0.0F, 1.0F) * static_cast<float>(patch.rows);
  const int ix = std::min(static_cast<int>(x), patch.cols - 1);
  const int iy = std::min(static_cast<int>(y), patch.rows - 1);
  const float tx = x - static_cast<float>(ix);
  const float ty = y - static_cast<float>(iy);
  const auto at = static_cast<std::size_t>(iy * (patch.cols + 1) + ix);
  const std::size_t above = at + static_cast<std::size_t>(patch.cols) + 1;
  const Vector3f low = values[at] + (values[at + 1] - values[at]) * tx;
  const Vector3f high = values[above] + (values[above + 1] - values[above]) * tx;
  return low + (high - low) * ty;
}

Patch curved_patch(int cols, int rows, const std::vector<Vector3d>& points,
                   const std::vector<Vector3d>& normals, Texture texture) {
  Patch patch;
  patch.cols = cols;
  patch.rows = rows;
  for (const Vector3d& point : points) patch.positions.push_back(point.cast<float>());
  for (const Vector3d& normal : normals) patch.normals.push_back(normal.cast<float>());
  patch.texture = std::move(texture);
  patch.light_texel_m = 0.02F;
  patch.texels_per_m = 700.0F;
  return patch;
}

}  // namespace

Vector3f Patch::position(float u, float v) const { return interpolate(*this, positions, u, v); }

Vector3f Patch::normal(float u, float v) const {
  return interpolate(*this, normals, u, v).normalized();
}

Vector3d Place::turn(const Vector3d& local) const {
  const double c = std::cos(yaw);
  const double s = std::sin(yaw);
  return {c * local.x() - s * local.y(), s * local.x() + c * local.y(), local.z()};
}

Vector3d Place::to_world(const Vector3d& local) const { return position + turn(local); }

int add_flat(RoomModel& model, const Vector3d& exact_origin, const Vector3d& exact_u,
             const Vector3d& exact_v, Texture texture, const FlatOptions& options) {
  const Vector3d origin = snap(exact_origin);
  const Vector3d u_axis = snap(exact_u);
  const Vector3d v_axis = snap(exact_v);
  const Vector3d cross = u_axis.cross(v_axis);
  const double area = cross.norm();
  const Vector3d normal = cross / area;
  const std::vector<Vector3d> ring = {origin, origin + u_axis, origin + u_axis + v_axis,
                                      origin + v_axis};
  Patch patch = curved_patch(1, 1, {ring[0], ring[1], ring[3], ring[2]},
                             std::vector<Vector3d>(4, normal), std::move(texture));
  patch.width_m = static_cast<float>(u_axis.norm());
  patch.height_m = static_cast<float>(v_axis.norm());
  patch.texels_per_m = options.texels_per_m;
  patch.light_texel_m = options.light_texel_m;
  if (area >= kMinPlaneArea && options.plane_class != "none") {
    TruePlane plane;
    plane.label = static_cast<int>(model.planes.size()) + 1;
    plane.plane_class = options.plane_class.empty() ? class_of(normal) : options.plane_class;
    plane.normal = normal;
    plane.offset = -normal.dot(origin);
    plane.polygon = ring;
    plane.area = area;
    patch.label = plane.label;
    model.planes.push_back(std::move(plane));
  }
  model.patches.push_back(std::move(patch));
  return static_cast<int>(model.patches.size()) - 1;
}

void add_box(RoomModel& model, const Place& place, const Vector3d& size,
             const BoxTextures& textures, const FlatOptions& options, bool underside) {
  // Every corner is the sum of the same numbers: watertight.
  const Vector3d across = snap(place.turn({size.x(), 0, 0}));
  const Vector3d deep = snap(place.turn({0, size.y(), 0}));
  const Vector3d up = snap({0, 0, size.z()});
  const Vector3d foot = snap(place.to_world({-0.5 * size.x(), -0.5 * size.y(), 0}));
  add_flat(model, foot, across, up, textures.front, options);
  add_flat(model, foot + across, deep, up, textures.right, options);
  add_flat(model, foot + across + deep, -across, up, textures.back, options);
  add_flat(model, foot + deep, -deep, up, textures.left, options);
  add_flat(model, foot + up, across, deep, textures.top, options);
  if (underside) add_flat(model, foot + deep, across, -deep, textures.front, options);
}

void add_revolution(RoomModel& model, const Place& place, const std::vector<ProfilePoint>& profile,
                    Texture texture, int segments, bool shines) {
  const int rows = static_cast<int>(profile.size()) - 1;
  std::vector<Vector3d> points;
  std::vector<Vector3d> normals;
  double length = 0.0;
  double widest = 0.0;
  for (int j = 0; j <= rows; ++j) {
    const ProfilePoint& p = profile[static_cast<std::size_t>(j)];
    const ProfilePoint& before = profile[static_cast<std::size_t>(std::max(j - 1, 0))];
    const ProfilePoint& after = profile[static_cast<std::size_t>(std::min(j + 1, rows))];
    const double dr = after.radius - before.radius;
    const double dh = after.height - before.height;
    const double norm = std::max(std::hypot(dr, dh), 1e-9);
    length += j > 0 ? std::hypot(p.radius - before.radius, p.height - before.height) : 0.0;
    widest = std::max(widest, p.radius);
    for (int i = 0; i <= segments; ++i) {
      const double angle = kTwoPi * i / segments;
      const Vector3d out(std::cos(angle), std::sin(angle), 0.0);
      points.push_back(place.to_world(out * p.radius + Vector3d(0, 0, p.height)));
      normals.push_back(place.turn(out * (dh / norm) - Vector3d(0, 0, dr / norm)));
    }
  }
  Patch patch = curved_patch(segments, rows, points, normals, std::move(texture));
  patch.width_m = static_cast<float>(kTwoPi * widest);
  patch.height_m = static_cast<float>(length);
  patch.shines = shines;
  patch.casts_shadow = !shines;
  model.patches.push_back(std::move(patch));
}

void add_ball(RoomModel& model, const Vector3d& centre, double radius, Texture texture) {
  std::vector<ProfilePoint> profile;
  const int rings = radius < 0.02 ? 4 : 8;
  for (int i = 0; i <= rings; ++i) {
    const double angle = std::numbers::pi * (static_cast<double>(i) / rings - 0.5);
    profile.push_back({radius * std::cos(angle), radius * std::sin(angle)});
  }
  add_revolution(model, {centre, 0.0}, profile, std::move(texture), radius < 0.02 ? 6 : 16);
}

void add_tube(RoomModel& model, const std::vector<Vector3d>& path, double radius, Texture texture,
              int segments) {
  const int rows = static_cast<int>(path.size()) - 1;
  std::vector<Vector3d> points;
  std::vector<Vector3d> normals;
  double length = 0.0;
  for (int j = 0; j <= rows; ++j) {
    const Vector3d& before = path[static_cast<std::size_t>(std::max(j - 1, 0))];
    const Vector3d& at = path[static_cast<std::size_t>(j)];
    const Vector3d& after = path[static_cast<std::size_t>(std::min(j + 1, rows))];
    const Vector3d along = (after - before).normalized();
    const Vector3d hint =
        std::abs(along.z()) < 0.9 ? Vector3d(Vector3d::UnitZ()) : Vector3d(Vector3d::UnitX());
    const Vector3d side = hint.cross(along).normalized();
    const Vector3d other = along.cross(side);
    length += (at - before).norm();
    for (int i = 0; i <= segments; ++i) {
      const double angle = kTwoPi * i / segments;
      const Vector3d out = std::cos(angle) * side + std::sin(angle) * other;
      points.push_back(at + radius * out);
      normals.push_back(out);
    }
  }
  Patch patch = curved_patch(segments, rows, points, normals, std::move(texture));
  patch.width_m = static_cast<float>(kTwoPi * radius);
  patch.height_m = static_cast<float>(length);
  model.patches.push_back(std::move(patch));
}

void add_sheet(RoomModel& model, int cols, int rows, const std::vector<Vector3d>& points,
               Texture texture, float width_m, float height_m, float texels_per_m) {
  const auto at = [&points, cols](int i, int j) {
    return points[static_cast<std::size_t>(j * (cols + 1) + i)];
  };
  std::vector<Vector3d> normals;
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i <= cols; ++i) {
      const Vector3d u = at(std::min(i + 1, cols), j) - at(std::max(i - 1, 0), j);
      const Vector3d v = at(i, std::min(j + 1, rows)) - at(i, std::max(j - 1, 0));
      const Vector3d cross = u.cross(v);
      normals.push_back(cross.norm() > 1e-12 ? Vector3d(cross.normalized())
                                             : Vector3d(Vector3d::UnitZ()));
    }
  }
  Patch patch = curved_patch(cols, rows, points, normals, std::move(texture));
  patch.width_m = width_m;
  patch.height_m = height_m;
  patch.texels_per_m = texels_per_m;
  model.patches.push_back(std::move(patch));
}

}  // namespace planecast::engine::synth
