#include "bench_scene.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "render/gltf/simplify.h"

namespace planecast::bench {
namespace {

constexpr float kPi = 3.14159265F;
constexpr int kTextureSide = 1024;

float bump(const glm::vec3& n) {
  return 0.02F * std::sin(9.0F * n.x) * std::sin(8.0F * n.y + 1.0F) * std::sin(7.0F * n.z + 2.0F);
}

glm::vec3 point_on(float polar, float around) {
  const glm::vec3 n(std::sin(polar) * std::cos(around), std::cos(polar),
                    -std::sin(polar) * std::sin(around));
  return n * (0.15F + bump(n));
}

render::Primitive ball_primitive(int triangles) {
  const int rings = static_cast<int>(std::lround(std::sqrt(triangles / 4.0)));
  render::Primitive ball;
  for (int i = 0; i <= rings; ++i) {
    for (int j = 0; j <= 2 * rings; ++j) {
      const float polar = kPi * static_cast<float>(i) / static_cast<float>(rings);
      const float around = kPi * static_cast<float>(j) / static_cast<float>(rings);
      constexpr float kStep = 1e-3F;
      const glm::vec3 p = point_on(polar, around);
      const glm::vec3 along = point_on(polar, around + kStep) - point_on(polar, around - kStep);
      const glm::vec3 down = point_on(polar + kStep, around) - point_on(polar - kStep, around);
      const glm::vec3 across = glm::cross(down, along);
      const glm::vec3 n = glm::length(across) > 1e-12F ? glm::normalize(across) : glm::normalize(p);
      const glm::vec3 t = glm::length(along) > 1e-9F ? glm::normalize(along) : glm::vec3(1, 0, 0);
      ball.shape.push_back({p + glm::vec3(0, 0.17F, 0), n, glm::vec4(t, 1.0F)});
      render::SurfaceVertex vertex;
      vertex.uv0 = {around / kPi, polar / kPi};
      ball.surface.push_back(vertex);
    }
  }
  const auto index = [rings](int i, int j) {
    return static_cast<std::uint32_t>(i * (2 * rings + 1) + j);
  };
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < 2 * rings; ++j) {
      ball.indices.insert(ball.indices.end(),
                          {index(i, j), index(i + 1, j), index(i, j + 1), index(i, j + 1),
                           index(i + 1, j), index(i + 1, j + 1)});
    }
  }
  ball.box = {ball.shape.front().position, ball.shape.front().position};
  for (const auto& vertex : ball.shape) {
    ball.box.min = glm::min(ball.box.min, vertex.position);
    ball.box.max = glm::max(ball.box.max, vertex.position);
  }
  return ball;
}

template <typename Texel>
render::ImageU8 paint(const Texel& texel) {
  render::ImageU8 image(kTextureSide, kTextureSide, 3);
  for (int y = 0; y < kTextureSide; ++y) {
    for (int x = 0; x < kTextureSide; ++x) {
      const glm::vec3 value = texel(static_cast<float>(x), static_cast<float>(y));
      for (int c = 0; c < 3; ++c) {
        image.pixels[static_cast<std::size_t>((y * kTextureSide + x) * 3 + c)] =
            static_cast<std::uint8_t>(255.0F * glm::clamp(value[c], 0.0F, 1.0F));
      }
    }
  }
  return image;
}

}  // namespace

std::shared_ptr<const render::Model> bumpy_ball(int triangles) {
  auto model = std::make_shared<render::Model>();
  model->images = {paint([](float x, float y) {
                     const float tile = std::sin(0.2F * x) * std::sin(0.2F * y);
                     return glm::vec3(0.6F + 0.3F * tile, 0.45F, 0.3F - 0.2F * tile);
                   }),
                   paint([](float x, float y) {
                     const glm::vec3 n(0.3F * std::sin(0.4F * x), 0.3F * std::sin(0.4F * y), 1.0F);
                     return 0.5F * glm::normalize(n) + 0.5F;
                   }),
                   paint([](float x, float) {
                     return glm::vec3(1.0F, 0.4F + 0.3F * std::sin(0.05F * x), 0.2F);
                   })};
  for (int i = 0; i < 3; ++i) {
    render::ModelTexture texture;
    texture.image = i;
    model->textures.push_back(texture);
  }
  render::Material material;
  material.base_color_map.texture = 0;
  material.normal_map.texture = 1;
  material.metallic_roughness_map.texture = 2;
  model->materials = {material};
  render::Primitive ball = ball_primitive(triangles);
  add_detail_levels(ball);
  model->meshes.resize(1);
  model->meshes[0].primitives.push_back(std::move(ball));
  model->nodes.resize(1);
  model->nodes[0].mesh = 0;
  model->order = {0};
  return model;
}

render::LayerScene table_scene(const std::shared_ptr<const render::Model>& model) {
  render::LayerScene scene;
  render::Instance instance;
  instance.model = model;
  scene.instances.push_back(instance);
  scene.with_depth = false;
  render::PlanePatch table;
  table.normal = {0, 1, 0};
  table.outer = {{-0.5F, 0, 0.5F}, {0.5F, 0, 0.5F}, {0.5F, 0, -0.5F}, {-0.5F, 0, -0.5F}};
  scene.catchers.push_back(table);
  render::Sun sun;
  sun.direction_to_light = glm::normalize(glm::vec3(0.5F, 1.0F, 0.3F));
  scene.light = render::Light::uniform(glm::vec3(0.4F), sun);
  return scene;
}

render::Camera camera_at(int frame) {
  render::Camera camera;
  const float angle = 0.01F * static_cast<float>(frame);
  const glm::vec3 eye(0.78F * std::sin(angle), 0.45F, 0.78F * std::cos(angle));
  // The world is y-up; the camera convention is y-down, z-forward.
  const glm::mat4 flip = glm::scale(glm::mat4(1.0F), glm::vec3(1, -1, -1));
  camera.camera_from_world = flip * glm::lookAt(eye, glm::vec3(0, 0.12F, 0), glm::vec3(0, 1, 0));
  return camera;
}

}  // namespace planecast::bench
