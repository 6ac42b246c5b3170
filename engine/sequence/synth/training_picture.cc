#include "engine/sequence/synth/training_picture.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "engine/sequence/synth/training_effects.h"

namespace planecast::engine::synth {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr float kPi = std::numbers::pi_v<float>;
constexpr int kShadowSide = 320;
constexpr int kFiner = 2;  // samples a pixel, along each axis

/// Looking along `forward`, x to the right, y down as far as that goes.
Eigen::Isometry3f look_from(const Vector3f& position, const Vector3f& forward, float roll) {
  const Vector3f z = forward.normalized();
  const Vector3f hint = std::abs(z.z()) < 0.98F ? Vector3f::UnitZ() : Vector3f::UnitX();
  const Vector3f x = z.cross(hint).normalized();
  Eigen::Matrix3f world_from_cam;
  world_from_cam << x, z.cross(x), z;
  Eigen::Isometry3f pose = Eigen::Isometry3f::Identity();
  pose.linear() = world_from_cam * Eigen::AngleAxisf(roll, Vector3f::UnitZ()).toRotationMatrix();
  pose.translation() = position;
  return pose.inverse();
}

Color warm(Random& random) {
  const auto t = static_cast<float>(random.uniform(-0.2, 0.25));
  return {1.0F + t, 1.0F, 1.0F - t};
}

}  // namespace

cv::Mat asked_labels(const cv::Mat& labels) {
  cv::Mat asked;
  labels.convertTo(asked, CV_16U);
  asked.setTo(0, labels == kIgnoredLabel);
  return asked;
}

TrainingPainter::TrainingPainter(const TrainingRoom& room, TileBank& bank, std::uint64_t seed)
    : room_(room), bank_(bank), triangles_(triangles_of(room.model)) {
  Random random(named_seed("training light", seed));
  const Vector3f size = room.size.cast<float>();
  const auto inside = [&](float margin) {
    return Vector3f(static_cast<float>(random.uniform(margin, 1.0 - margin)) * size.x(),
                    static_cast<float>(random.uniform(margin, 1.0 - margin)) * size.y(), 0.0F);
  };
  ambient_ = warm(random) * static_cast<float>(random.uniform(0.15, 0.7));
  const int lamps = random.below(3);
  for (int i = 0; i < lamps; ++i) {
    Vector3f at = inside(0.2F);
    at.z() = size.z() - 0.15F;
    add_light(random, at, -Vector3f::UnitZ(),
              warm(random) * static_cast<float>(random.uniform(0.8, 4.0)), 2.6F);
  }
  if (lamps == 0 || random.uniform() < 0.5) {  // daylight from beside
    const bool along_x = random.below(2) == 0;
    const bool far = random.below(2) == 0;
    Vector3f at = inside(0.25F);
    at[along_x ? 0 : 1] = far ? size[along_x ? 0 : 1] - 0.06F : 0.06F;
    at.z() = static_cast<float>(random.uniform(1.0, 2.0));
    Vector3f forward = Vector3f::Zero();
    forward[along_x ? 0 : 1] = far ? -1.0F : 1.0F;
    forward.z() = static_cast<float>(random.uniform(-0.5, 0.0));
    add_light(random, at, forward, warm(random) * static_cast<float>(random.uniform(1.0, 6.0)),
              1.8F);
  }
}

void TrainingPainter::add_light(Random& random, const Vector3f& position, const Vector3f& forward,
                                const Color& power, float half_field) {
  Light light;
  light.position = position;
  light.power = power;
  light.softness = 1 + random.below(7);
  light.casts = random.uniform() < 0.85;
  light.camera.width = light.camera.height = kShadowSide;
  light.camera.cx = light.camera.cy = 0.5F * (kShadowSide - 1);
  light.camera.fx = light.camera.fy = 0.5F * kShadowSide / half_field;
  light.camera.cam_from_world = look_from(position, forward, 0.0F);
  if (light.casts) light.shadow = rasterise(triangles_, light.camera);
  lights_.push_back(std::move(light));
}

RasterCamera TrainingPainter::random_camera(Random& random) const {
  RasterCamera camera;
  camera.width = kFiner * kTrainingWidth;
  camera.height = kFiner * kTrainingHeight;
  const bool portrait = random.uniform() < 0.25;
  const double ratio = random.uniform() < 0.6 ? 4.0 / 3.0 : random.uniform(1.25, 1.8);
  const double field = random.uniform(45.0, 100.0) * std::numbers::pi / 180.0;  // of the long side
  const double along = std::tan(0.5 * field);
  const double across = along / ratio;
  camera.fx = static_cast<float>(0.5 * camera.width / (portrait ? across : along));
  camera.fy = static_cast<float>(0.5 * camera.height / (portrait ? along : across));
  camera.cx = 0.5F * static_cast<float>(camera.width - 1);
  camera.cy = 0.5F * static_cast<float>(camera.height - 1);

  const Vector3f size = room_.size.cast<float>();
  Vector3f target(static_cast<float>(random.uniform() * size.x()),
                  static_cast<float>(random.uniform() * size.y()),
                  static_cast<float>(random.uniform() * size.z()));
  if (!room_.sights.empty() && random.uniform() < 0.75) {
    target =
        room_.sights[static_cast<std::size_t>(random.below(static_cast<int>(room_.sights.size())))]
            .cast<float>();
  }
  const auto distance = static_cast<float>(std::exp(random.uniform(std::log(0.5), std::log(4.5))));
  const auto azimuth = static_cast<float>(random.uniform(-kPi, kPi));
  const auto elevation = static_cast<float>(random.uniform(-0.15, 1.1));
  Vector3f position =
      target + distance * Vector3f(std::cos(elevation) * std::cos(azimuth),
                                   std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
  for (int axis = 0; axis < 3; ++axis) {
    const float low = axis == 2 ? 0.25F : 0.12F;
    position[axis] = std::clamp(position[axis], low, size[axis] - 0.12F);
  }
  Vector3f forward = target - position;
  if (forward.norm() < 0.2F) forward = Vector3f(std::cos(azimuth), std::sin(azimuth), -0.3F);
  const double tilt = random.uniform() < 0.85 ? random.normal() * 0.07 : random.normal() * 0.5;
  camera.cam_from_world = look_from(position, forward, static_cast<float>(tilt));
  return camera;
}

double TrainingPainter::dislike(const RasterImage& image, Random& random) const {
  int close = 0;
  int flat = 0;
  std::map<int, int> pixels;
  for (std::size_t i = 0; i < image.triangle.size(); ++i) {
    close += image.inverse_depth[i] > 1.0F / 0.22F;
    if (image.triangle[i] < 0) continue;
    const int plane = room_.plane[static_cast<std::size_t>(
        triangles_[static_cast<std::size_t>(image.triangle[i])].patch)];
    flat += plane != 0;
    if (plane != 0) ++pixels[plane];
  }
  int largest = 0;
  for (const auto& [plane, count] : pixels) largest = std::max(largest, count);
  const auto total = static_cast<double>(image.triangle.size());
  const double lonely = std::max(0.0, largest / total - 0.6);
  return (close > 0.12 * total ? 10.0 : 0.0) + 2.0 * lonely + 0.9 * flat / total +
         random.uniform(0.0, 0.5);
}

TrainingPainter::View TrainingPainter::choose_view(Random& random) const {
  constexpr int kTries = 4;
  constexpr int kCoarser = 8;
  RasterCamera best;
  double least = 1e9;
  for (int i = 0; i < kTries; ++i) {
    const RasterCamera camera = random_camera(random);
    RasterCamera coarse = camera;
    coarse.width /= kCoarser;
    coarse.height /= kCoarser;
    for (float* value : {&coarse.fx, &coarse.fy, &coarse.cx, &coarse.cy}) *value /= kCoarser;
    const double cost = dislike(rasterise(triangles_, coarse), random);
    if (cost < least) {
      least = cost;
      best = camera;
    }
  }
  return {best, rasterise(triangles_, best)};
}

Color TrainingPainter::surface(const RasterTriangle& triangle, const Vector2f& uv,
                               float footprint_m, Color& glow) const {
  const TrainingMaterial& material = room_.materials[static_cast<std::size_t>(triangle.patch)];
  const TrainingPaint* paint = &material.paint;
  Vector2f at = uv;
  float dark = 1.0F;
  for (auto decal = material.decals.rbegin(); decal != material.decals.rend(); ++decal) {
    const float u = uv.x() - decal->u_m;
    const float v = uv.y() - decal->v_m;
    if (u < 0.0F || v < 0.0F || u > decal->width_m || v > decal->height_m) continue;
    paint = &decal->paint;
    at = {u, v};
    const float rim = std::min({u, v, decal->width_m - u, decal->height_m - v});
    if (rim < decal->rim_m) dark = 0.5F;
    break;
  }
  const TilePyramid& tile = bank_.tile(paint->kind, paint->tile);
  const Color color =
      dark * tile.at(at.x() / paint->repeat_m + paint->shift.x(),
                     at.y() / paint->repeat_m + paint->shift.y(), footprint_m / paint->repeat_m)
                 .cwiseProduct(paint->tint);
  glow = paint->glow * color;
  return color;
}

float TrainingPainter::lit(const Light& light, const Vector3f& point, std::uint32_t hash) const {
  if (!light.casts) return 1.0F;
  const Vector3f p = light.camera.cam_from_world * point;
  if (p.z() < 0.05F) return 1.0F;
  const float inverse = 1.0F / p.z();
  const float x = light.camera.fx * p.x() * inverse + light.camera.cx;
  const float y = light.camera.fy * p.y() * inverse + light.camera.cy;
  const float reach = static_cast<float>(light.softness);
  if (x < reach || y < reach || x >= kShadowSide - reach - 1 || y >= kShadowSide - reach - 1) {
    return 1.0F;
  }
  const float angle = static_cast<float>(hash & 255U) * (2.0F * kPi / 256.0F);
  const float c = std::cos(angle);
  const float s = std::sin(angle);
  static constexpr float kTaps[4][2] = {{0.2F, 0.3F}, {-0.5F, 0.4F}, {-0.3F, -0.8F}, {0.9F, -0.2F}};
  float sum = 0.0F;
  for (const auto& tap : kTaps) {
    const int column = static_cast<int>(x + reach * (c * tap[0] - s * tap[1]) + 0.5F);
    const int row = static_cast<int>(y + reach * (s * tap[0] + c * tap[1]) + 0.5F);
    const float nearest =
        light.shadow.inverse_depth[static_cast<std::size_t>(row * kShadowSide + column)];
    // In depth, a blocker must be a few centimetres nearer.
    sum += nearest > inverse * 1.0F + 0.05F * inverse * inverse ? 0.0F : 0.25F;
  }
  return sum;
}

Color TrainingPainter::shade(const View& view, int x, int y) const {
  const auto at = static_cast<std::size_t>(y * view.camera.width + x);
  if (view.image.triangle[at] < 0) return Color::Constant(0.02F);
  const RasterTriangle& t = triangles_[static_cast<std::size_t>(view.image.triangle[at])];
  const Eigen::Isometry3f& pose = view.camera.cam_from_world;
  const float z = 1.0F / view.image.inverse_depth[at];
  const Vector3f in_cam = z * view.camera.ray(static_cast<float>(x), static_cast<float>(y));
  const Vector3f point = pose.linear().transpose() * (in_cam - pose.translation());
  const Vector3f eye = -(pose.linear().transpose() * in_cam).normalized();

  const Vector3f d = point - t.corner;
  const float aa = t.edge_a.squaredNorm();
  const float ab = t.edge_a.dot(t.edge_b);
  const float bb = t.edge_b.squaredNorm();
  const float da = d.dot(t.edge_a);
  const float db = d.dot(t.edge_b);
  const float scale = 1.0F / std::max(aa * bb - ab * ab, 1e-20F);
  const float share_a = std::clamp((bb * da - ab * db) * scale, 0.0F, 1.0F);
  const float share_b = std::clamp((aa * db - ab * da) * scale, 0.0F, 1.0F);
  Vector3f normal = (t.normal + share_a * t.normal_a + share_b * t.normal_b).normalized();
  float facing = normal.dot(eye);
  if (facing < 0.0F) {
    normal = -normal;
    facing = -facing;
  }
  const Vector2f uv = t.uv + share_a * t.uv_a + share_b * t.uv_b;

  const float footprint = z / view.camera.fx / std::max(facing, 0.25F);
  Color glow;
  const Color albedo = surface(t, uv, footprint, glow);
  const TrainingMaterial& material = room_.materials[static_cast<std::size_t>(t.patch)];

  // Corners of the room see less of it.
  float open = 1.0F;
  for (int axis = 0; axis < 3; ++axis) {
    const auto far = static_cast<float>(room_.size[axis]) - point[axis];
    if (normal[axis] < 0.9F) open *= 1.0F - 0.35F / (1.0F + 25.0F * point[axis] * point[axis]);
    if (normal[axis] > -0.9F) open *= 1.0F - 0.35F / (1.0F + 25.0F * far * far);
  }
  Color light_sum = ambient_ * (open * (0.75F + 0.25F * normal.z()));
  Color shine = Color::Zero();
  const auto hash = static_cast<std::uint32_t>(mix_bits(at));
  for (const Light& light : lights_) {
    const Vector3f way = light.position - point;
    const float distance2 = way.squaredNorm() + 0.09F;
    const Vector3f direction = way / std::sqrt(distance2);
    const float cosine = normal.dot(direction);
    if (cosine <= 0.0F) continue;
    const float share = lit(light, point + 0.01F * normal, hash) / distance2;
    light_sum += light.power * (cosine * share);
    if (material.gloss > 0.0F) {
      const float half = normal.dot((direction + eye).normalized());
      shine += light.power *
               (material.gloss * share * std::pow(std::max(half, 0.0F), material.highlight));
    }
  }
  return albedo.cwiseProduct(light_sum) + shine + glow;
}

void TrainingPainter::write_truth(const View& view, const TrainingViewOptions& options,
                                  TrainingSample& sample) const {
  sample.labels = cv::Mat::zeros(kTrainingHeight, kTrainingWidth, CV_8U);
  sample.normals = cv::Mat::zeros(kTrainingHeight, kTrainingWidth, CV_8SC3);
  cv::Mat planes = cv::Mat::zeros(kTrainingHeight, kTrainingWidth, CV_32S);
  std::map<int, int> pixels;
  for (int y = 0; y < kTrainingHeight; ++y) {
    for (int x = 0; x < kTrainingWidth; ++x) {
      const int column = kFiner * x + 1;
      const int row = kFiner * y + 1;
      const int index =
          view.image.triangle[static_cast<std::size_t>(row * view.camera.width + column)];
      if (index < 0) continue;
      const RasterTriangle& triangle = triangles_[static_cast<std::size_t>(index)];
      Vector3f normal = view.camera.cam_from_world.linear() * triangle.normal;
      const Vector3f ray = view.camera.ray(static_cast<float>(column), static_cast<float>(row));
      if (normal.dot(ray) > 0.0F) normal = -normal;
      for (int c = 0; c < 3; ++c) {
        sample.normals.at<cv::Vec<schar, 3>>(y, x)[c] =
            static_cast<schar>(std::lround(127.0F * normal[c]));
      }
      const int plane = room_.plane[static_cast<std::size_t>(triangle.patch)];
      planes.at<int>(y, x) = plane;
      if (plane != 0) ++pixels[plane];
    }
  }
  std::map<int, int> label_of;
  int next = 1;
  const double needed = options.min_plane_share * kTrainingWidth * kTrainingHeight;
  for (const auto& [plane, count] : pixels) {
    label_of[plane] = count >= needed && next < kIgnoredLabel ? next++ : kIgnoredLabel;
  }
  int planar = 0;
  for (int y = 0; y < kTrainingHeight; ++y) {
    for (int x = 0; x < kTrainingWidth; ++x) {
      const int plane = planes.at<int>(y, x);
      if (plane == 0) continue;
      const int label = label_of[plane];
      planar += label != kIgnoredLabel;
      sample.labels.at<unsigned char>(y, x) = static_cast<unsigned char>(label);
    }
  }
  sample.non_planar = 1.0 - static_cast<double>(planar) / (kTrainingWidth * kTrainingHeight);
}

TrainingSample TrainingPainter::draw(std::uint64_t view_seed, const TrainingViewOptions& options) {
  Random random(named_seed("training view", view_seed));
  const View view = choose_view(random);
  cv::Mat light(view.camera.height, view.camera.width, CV_32FC3);
  for (int y = 0; y < light.rows; ++y) {
    for (int x = 0; x < light.cols; ++x) {
      const Color color = shade(view, x, y);
      light.at<cv::Vec3f>(y, x) = {color.x(), color.y(), color.z()};
    }
  }
  cv::resize(light, light, {kTrainingWidth, kTrainingHeight}, 0, 0, cv::INTER_AREA);
  TrainingSample sample;
  sample.bgr = take_training_picture(light, random);
  write_truth(view, options, sample);
  return sample;
}

}  // namespace planecast::engine::synth
