#include "engine/scene/poster.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <opencv2/imgproc.hpp>

#include "engine/sequence/image_file.h"
#include "engine/sequence/video_sequence.h"

namespace planecast::engine {
namespace {

constexpr float kThickness = 0.012F;  ///< of the width: a board, so that it has a contact shadow
constexpr int kMostPixels = 1536;  ///< a side of the texture; a picture in a picture needs no more

render::ImageU8 to_texture(const cv::Mat& bgr) {
  cv::Mat rgb;
  cv::cvtColor(bgr, rgb, cv::COLOR_BGR2RGB);
  const double shrink = static_cast<double>(kMostPixels) / std::max(rgb.cols, rgb.rows);
  if (shrink < 1.0) cv::resize(rgb, rgb, cv::Size(), shrink, shrink, cv::INTER_AREA);
  render::ImageU8 image(rgb.cols, rgb.rows, 3);
  const auto row_bytes = static_cast<std::size_t>(rgb.cols) * 3;
  for (int y = 0; y < rgb.rows; ++y) {
    std::memcpy(image.pixels.data() + static_cast<std::size_t>(y) * row_bytes, rgb.ptr(y),
                row_bytes);
  }
  return image;
}

/// Two triangles; `corners` counter-clockwise seen from the front, from the lower left one on.
void add_face(const std::array<glm::vec3, 4>& corners, render::Primitive& primitive) {
  const auto first = static_cast<std::uint32_t>(primitive.shape.size());
  const glm::vec3 normal =
      glm::normalize(glm::cross(corners[1] - corners[0], corners[3] - corners[0]));
  constexpr std::array<glm::vec2, 4> kUv = {{{0, 1}, {1, 1}, {1, 0}, {0, 0}}};
  for (std::size_t i = 0; i < 4; ++i) {
    primitive.shape.push_back({corners[i], normal, glm::vec4(0.0F)});
    primitive.surface.push_back({kUv[i], glm::vec2(0.0F), glm::vec4(1.0F)});
  }
  for (const std::uint32_t i : {0U, 1U, 2U, 0U, 2U, 3U}) primitive.indices.push_back(first + i);
}

render::Mesh board(float height) {
  const float x = 0.5F;
  const float z = kThickness;
  const std::array<glm::vec3, 4> front = {{{-x, 0, z}, {x, 0, z}, {x, height, z}, {-x, height, z}}};
  render::Primitive print;
  render::Primitive edges;
  add_face(front, print);
  for (std::size_t i = 0; i < 4; ++i) {
    const glm::vec3 a = front[i];
    const glm::vec3 b = front[(i + 1) % 4];
    add_face({{{a.x, a.y, 0}, {b.x, b.y, 0}, b, a}}, edges);
  }
  print.material = 0;
  edges.material = 1;
  const render::Box box{{-x, 0, 0}, {x, height, z}};
  print.box = edges.box = box;
  return {{print, edges}, {}};
}

double shape_of(const cv::Mat& bgr) { return static_cast<double>(bgr.rows) / bgr.cols; }

std::shared_ptr<const render::Model> print_of(const cv::Mat& bgr) {
  auto model = std::make_shared<render::Model>();
  model->images.push_back(to_texture(bgr));
  render::ModelTexture texture;
  texture.image = 0;
  texture.wrap_s = texture.wrap_t = 33071;  // clamp to edge
  model->textures.push_back(texture);
  render::Material print;
  print.metallic = 0.0F;
  print.roughness = 0.7F;
  print.base_color_map.texture = 0;
  render::Material paper;
  paper.metallic = 0.0F;
  paper.roughness = 0.9F;
  paper.base_color = glm::vec4(0.85F, 0.85F, 0.85F, 1.0F);
  model->materials = {print, paper, render::Material{}};
  model->meshes.push_back(board(static_cast<float>(shape_of(bgr))));
  render::Node node;
  node.name = "poster";
  node.mesh = 0;
  model->nodes.push_back(node);
  model->order = {0};
  return model;
}

}  // namespace

PosterPrint::PosterPrint(const Poster& poster) {
  if (!poster.video) {
    const cv::Mat picture = read_color_image(poster.file);
    height_ = shape_of(picture);
    shown_.push_back({0, print_of(picture)});
    return;
  }
  video_ = open_video(poster.file, {});
  height_ = shape_of(video_->read(0).image);
}

std::shared_ptr<const render::Model> PosterPrint::at(double time_s, bool loop) {
  if (!video_) return shown_.front().model;
  const int frames = video_->end_frame();
  // A frame shows from its own time on; rounding must not show the one before it.
  const auto wanted = static_cast<long>(std::floor(time_s * video_->fps() + 1e-6));
  const auto frame = static_cast<int>(loop ? wanted % frames : std::min<long>(wanted, frames - 1));
  const std::lock_guard lock(mutex_);
  const auto known = std::ranges::find(shown_, frame, &Shown::frame);
  if (known != shown_.end()) return known->model;
  shown_.push_back({frame, print_of(video_->read(frame).image)});
  if (shown_.size() > kKept) shown_.pop_front();
  return shown_.back().model;
}

}  // namespace planecast::engine
