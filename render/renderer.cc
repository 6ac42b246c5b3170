#include "render/renderer.h"

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "render/context/context.h"
#include "render/gl/program.h"
#include "render/passes/surfaces.h"
#include "render/passes/targets.h"

namespace planecast::render {
namespace {

constexpr float kSqrt4Pi = 3.5449077F;

std::unique_ptr<GlContext> create_current_context(ContextKind kind) {
  auto context = create_context(kind);
  context->make_current();
  return context;
}

void check_camera(const Camera& camera) {
  constexpr int kLargestSide = 16384;
  if (camera.width < 1 || camera.height < 1 || camera.width > kLargestSide ||
      camera.height > kLargestSide) {
    throw std::invalid_argument("renderer: picture size " + std::to_string(camera.width) + "x" +
                                std::to_string(camera.height));
  }
}

}  // namespace

Light Light::uniform(glm::vec3 ambient_radiance, Sun sun) {
  Light light;
  light.ambient_sh[0] = ambient_radiance * kSqrt4Pi;
  light.sun = sun;
  return light;
}

struct Renderer::Impl {
  explicit Impl(const RendererOptions& given)
      : options(given),
        context(create_current_context(given.context)),
        gl(load_functions(*context)),
        shaders(gl, given.shader_dir),
        shadow_map(gl, std::clamp(given.shadow_map_size, 64, 8192)),
        surfaces(gl) {
    gl.ClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  }

  /// Targets of the camera's size; kept while it stays the same.
  void resize(const Camera& camera) {
    check_camera(camera);
    if (color && color->width() == camera.width && color->height() == camera.height) return;
    color.emplace(gl, camera.width, camera.height, options.msaa_samples > 1 ? 4 : 1);
    geometry.emplace(gl, camera.width, camera.height);
  }

  OpaqueImages draw_opaque(const OpaqueScene& scene, const Camera& camera);

  RendererOptions options;
  std::unique_ptr<GlContext> context;
  Gl gl;
  ShaderLibrary shaders;
  ShadowMap shadow_map;
  SurfaceSet surfaces;
  std::optional<ColorTarget> color;
  std::optional<GeometryTarget> geometry;
};

OpaqueImages Renderer::Impl::draw_opaque(const OpaqueScene& scene, const Camera& camera) {
  resize(camera);
  surfaces.update(scene.surfaces);
  const Sun& sun = scene.light.sun;
  const bool shadows = sun.casts_shadow && sun.radiance != glm::vec3(0.0F);
  if (shadows) {
    const glm::vec3 to_light = glm::normalize(sun.direction_to_light);
    const float margin = 2.0F + 2.0F * sun.softness;
    shadow_map.begin(fit_shadow(to_light, surfaces.box_points(), shadow_map.size(), margin));
    surfaces.draw_shadow(shaders, shadow_map.projection(), to_light);
  }

  const Layer::Rect whole{0, 0, camera.width, camera.height};
  color->begin(whole);
  gl.Enable(GL_DEPTH_TEST);
  gl.DepthFunc(GL_GREATER);
  gl.Disable(GL_CULL_FACE);
  gl.Disable(GL_BLEND);
  surfaces.draw_color(shaders, scene, camera, shadows ? &shadow_map : nullptr);
  OpaqueImages images{ImageU8(camera.width, camera.height, 3),
                      ImageF(camera.width, camera.height, 1),
                      Image<std::uint16_t>(camera.width, camera.height, 1)};
  color->resolve(whole, images.rgb);

  geometry->begin(whole);
  surfaces.draw_geometry(shaders, scene.surfaces, camera);
  geometry->read_depth(whole, images.depth);
  geometry->read_labels(whole, images.labels);
  return images;
}

Renderer::Renderer(const RendererOptions& options) : impl_(std::make_unique<Impl>(options)) {}

Renderer::~Renderer() {
  if (impl_ != nullptr) impl_->context->make_current();
}

Layer Renderer::draw_layer(const LayerScene&, const Camera& camera) {
  Layer layer;
  layer.rgba = ImageU8(camera.width, camera.height, 4);
  layer.depth = ImageF(camera.width, camera.height, 1);
  return layer;
}

OpaqueImages Renderer::draw_opaque(const OpaqueScene& scene, const Camera& camera) {
  impl_->context->make_current();
  return impl_->draw_opaque(scene, camera);
}

void Renderer::forget() {
  impl_->context->make_current();
  impl_->surfaces.clear();
}

std::string Renderer::description() const {
  impl_->context->make_current();
  return reinterpret_cast<const char*>(impl_->gl.GetString(GL_VERSION));
}

}  // namespace planecast::render
