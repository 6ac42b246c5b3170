#include "render/renderer.h"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <optional>
#include <stdexcept>
#include <string>

#include "render/context/context.h"
#include "render/gl/program.h"
#include "render/passes/catchers.h"
#include "render/passes/content_hash.h"
#include "render/passes/environment_map.h"
#include "render/passes/model_passes.h"
#include "render/passes/models.h"
#include "render/passes/occluders.h"
#include "render/passes/pass_clock.h"
#include "render/passes/sun_shadow.h"
#include "render/passes/surfaces.h"
#include "render/passes/targets.h"
#include "render/passes/view.h"
#include "render/software/software_input.h"
#include "render/software/software_painter.h"

namespace planecast::render {
namespace {

constexpr float kSqrt4Pi = 3.5449077F;
std::unique_ptr<GlContext> create_current_context(const RendererOptions& options) {
  // Read once by Mesa when it finds out about the processor; a setting from outside wins.
  if (options.portable_floats) setenv("GALLIUM_OVERRIDE_CPU_CAPS", "sse4.1", 0);
  auto context = create_context(options.context);
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

int shadow_map_size(const RendererOptions& options) {
  const int size = std::clamp(options.shadow_map_size, 64, 8192);
  return static_cast<int>(std::bit_floor(static_cast<unsigned>(size)));
}

/// Whether the shadows are the same in every frame. Told by the scene, not by the last frame, so
/// that a picture never depends on those drawn before it.
bool stands_still(const LayerScene& scene) {
  return scene.still && std::ranges::all_of(scene.instances, [](const Instance& instance) {
           return instance.model == nullptr || instance.animation < 0 ||
                  static_cast<std::size_t>(instance.animation) >= instance.model->animations.size();
         });
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
        context(create_current_context(given)),
        gl(load_functions(*context)),
        shaders(gl, given.shader_dir),
        sun_shadow(gl, shadow_map_size(given), given.simplify_px),
        surfaces(gl),
        models(gl),
        model_passes(gl, shaders, models),
        catchers(gl, model_passes),
        occluders(gl),
        environment(gl),
        software(shadow_map_size(given), given.simplify_px) {
    gl.ClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    gl.Enable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
  }

  /// Targets for the window; kept while they fit. What they hold does not depend on their size.
  void prepare_targets(const Window& window) {
    if (color && fits(color->width(), color->height(), window.rect)) return;
    const int width = whole_tiles(window.rect.width);
    const int height = whole_tiles(window.rect.height);
    color.reset();
    geometry.reset();
    color.emplace(gl, width, height, options.msaa_samples > 1 ? 4 : 1);
    geometry.emplace(gl, width, height);
  }

  Layer draw_layer(const LayerScene& scene, const Camera& camera);
  void draw_by_opengl(const LayerScene& scene, const Camera& camera, const PosedItems& posed,
                      Layer& layer);
  void draw_layer_color(const LayerScene& scene, const Camera& camera, const CatcherInput& catching,
                        const ShadingInput& shading, const Window& window, Layer& layer);
  OpaqueImages draw_opaque(const OpaqueScene& scene, const Camera& camera);
  GLuint upload_occluder_depth(const LayerScene& scene, const Window& window);
  void light_by(const Light& light, ShadingInput& shading);
  void begin_opaque_state() const;
  void check_errors() const;

  RendererOptions options;
  std::unique_ptr<GlContext> context;
  Gl gl;
  ShaderLibrary shaders;
  SunShadow sun_shadow;
  SurfaceSet surfaces;
  ModelSet models;
  ModelPasses model_passes;
  CatcherPass catchers;
  OccluderPass occluders;
  EnvironmentMap environment;
  SoftwarePainter software;
  std::optional<ColorTarget> color;
  std::optional<GeometryTarget> geometry;
  TextureHandle occluder_depth;
  Layer::Rect occluder_depth_rect;
  PassClock clock{gl, options.time_passes};
};

void Renderer::Impl::light_by(const Light& light, ShadingInput& shading) {
  shading.light = &light;
  if (light.environment == nullptr) return;
  shading.environment = environment.texture(light.environment);
  shading.environment_levels = light.environment->levels();
}

void Renderer::Impl::begin_opaque_state() const {
  gl.Enable(GL_DEPTH_TEST);
  gl.DepthFunc(GL_GREATER);
  gl.DepthMask(GL_TRUE);
  gl.Disable(GL_CULL_FACE);
  gl.Disable(GL_BLEND);
}

void Renderer::Impl::check_errors() const {
  const GLenum error = gl.GetError();
  if (error != GL_NO_ERROR) throw std::runtime_error("OpenGL error " + std::to_string(error));
}

/// The window's part of the depth image, so that the shaders find it by their own pixel.
GLuint Renderer::Impl::upload_occluder_depth(const LayerScene& scene, const Window& window) {
  const ImageF* depth = scene.occluder_depth;
  if (depth == nullptr || depth->width != window.picture_width ||
      depth->height != window.picture_height) {
    return 0;
  }
  const Layer::Rect& rect = window.rect;
  if (!occluder_depth || occluder_depth_rect.width != rect.width ||
      occluder_depth_rect.height != rect.height) {
    occluder_depth = make_target(gl, GL_R32F, rect.width, rect.height);
    occluder_depth_rect = rect;
  }
  gl.PixelStorei(GL_UNPACK_ALIGNMENT, 4);
  gl.PixelStorei(GL_UNPACK_ROW_LENGTH, depth->width);
  const std::size_t first =
      static_cast<std::size_t>(rect.y) * static_cast<std::size_t>(depth->width) +
      static_cast<std::size_t>(rect.x);
  gl.TextureSubImage2D(occluder_depth.id(), 0, 0, 0, rect.width, rect.height, GL_RED, GL_FLOAT,
                       depth->pixels.data() + first);
  gl.PixelStorei(GL_UNPACK_ROW_LENGTH, 0);
  return occluder_depth.id();
}

Layer Renderer::Impl::draw_layer(const LayerScene& scene, const Camera& camera) {
  check_camera(camera);
  clock.start();
  Layer layer;
  layer.rgba = ImageU8(camera.width, camera.height, 4);
  if (scene.with_depth) layer.depth = ImageF(camera.width, camera.height, 1);
  const std::vector<DrawItem>& items = models.pose(scene.instances);
  if (items.empty()) return layer;

  clock.end_of("pose");
  const std::vector<glm::vec3> points = world_box_points(items);
  const PosedItems posed{&items, &points, caster_signature(models, scene.light.sun),
                         stands_still(scene)};
  if (!options.only_opengl && options.msaa_samples > 1 &&
      drawable_by_processor(scene, camera, items, !models.lamps().empty())) {
    software.draw(scene, camera, posed, clock, layer);
  } else {
    draw_by_opengl(scene, camera, posed, layer);
  }
  check_errors();
  return layer;
}

void Renderer::Impl::draw_by_opengl(const LayerScene& scene, const Camera& camera,
                                    const PosedItems& posed, Layer& layer) {
  CatcherInput catching;
  catching.scene = &scene;
  catching.camera = &camera;
  catching.items = posed.items;
  catching.caster_points = posed.points;
  catching.shadow =
      sun_shadow.update(scene.light.sun, {posed.items, posed.points, nullptr, posed.signature},
                        model_passes, shaders);
  catching.casters = posed.signature;
  catching.still = posed.still;
  catching.detail_texels = options.simplify_px;
  catchers.prepare(shaders, catching);
  clock.end_of("catcher maps");
  layer.bounds = layer_bounds(camera, *posed.points, catchers.touched_points(catching));
  if (layer.bounds.width == 0) return;

  const Window window{camera.width, camera.height, layer.bounds};
  prepare_targets(window);
  ShadingInput shading;
  shading.camera = &camera;
  light_by(scene.light, shading);
  shading.exposure = scene.exposure;
  shading.tone_map = scene.tone_map;
  shading.shadow = catching.shadow;
  shading.occluder_depth = upload_occluder_depth(scene, window);
  shading.multisampled = options.msaa_samples > 1;
  shading.detail_px = options.simplify_px;
  draw_layer_color(scene, camera, catching, shading, window, layer);

  if (scene.with_depth) {
    geometry->begin(window);
    begin_opaque_state();
    occluders.draw(shaders, scene.occluders, camera);
    begin_opaque_state();
    model_passes.draw_geometry(*catching.items, shading);
    geometry->read_depth(window, layer.depth);
    clock.end_of("depth");
  }
}

void Renderer::Impl::draw_layer_color(const LayerScene& scene, const Camera& camera,
                                      const CatcherInput& catching, const ShadingInput& shading,
                                      const Window& window, Layer& layer) {
  color->begin(window);
  begin_opaque_state();
  occluders.draw(shaders, scene.occluders, camera);
  clock.end_of("clear and occluders");
  catchers.draw(shaders, catching, shading.occluder_depth,
                kCatcherTolerance * shading.occluder_tolerance);
  begin_opaque_state();
  clock.end_of("catchers");
  model_passes.draw_color(*catching.items, shading);
  clock.end_of("objects");
  color->resolve(window, layer.rgba);
  clock.end_of("resolve and read");
}

OpaqueImages Renderer::Impl::draw_opaque(const OpaqueScene& scene, const Camera& camera) {
  check_camera(camera);
  surfaces.update(scene.surfaces);
  const std::vector<DrawItem>& items = models.pose(scene.instances);
  const Sun& sun = scene.light.sun;
  std::vector<glm::vec3> points = world_box_points(items);
  points.insert(points.end(), surfaces.box_points().begin(), surfaces.box_points().end());
  ContentHash signature;
  signature.add(caster_signature(models, sun));
  signature.add(surfaces.signature());
  const ShadowMap* shadow = sun_shadow.update(sun, {&items, &points, &surfaces, signature.value()},
                                              model_passes, shaders);

  ShadingInput shading;
  shading.camera = &camera;
  light_by(scene.light, shading);
  shading.shadow = shadow;
  shading.exposure = scene.exposure;
  shading.multisampled = options.msaa_samples > 1;
  shading.detail_px = options.simplify_px;

  const Window whole{camera.width, camera.height, {0, 0, camera.width, camera.height}};
  prepare_targets(whole);
  color->begin(whole);
  begin_opaque_state();
  surfaces.draw_color(shaders, scene, camera, shadow);
  model_passes.draw_color(items, shading);
  OpaqueImages images{ImageU8(camera.width, camera.height, 3),
                      ImageF(camera.width, camera.height, 1),
                      Image<std::uint16_t>(camera.width, camera.height, 1)};
  color->resolve(whole, images.rgb);

  geometry->begin(whole);
  begin_opaque_state();
  surfaces.draw_geometry(shaders, scene.surfaces, camera);
  model_passes.draw_geometry(items, shading);
  geometry->read_depth(whole, images.depth);
  geometry->read_labels(whole, images.labels);
  check_errors();
  return images;
}

Renderer::Renderer(const RendererOptions& options) : impl_(std::make_unique<Impl>(options)) {}

Renderer::~Renderer() { impl_->context->make_current(); }

Layer Renderer::draw_layer(const LayerScene& scene, const Camera& camera) {
  impl_->context->make_current();
  return impl_->draw_layer(scene, camera);
}

OpaqueImages Renderer::draw_opaque(const OpaqueScene& scene, const Camera& camera) {
  impl_->context->make_current();
  return impl_->draw_opaque(scene, camera);
}

void Renderer::forget() {
  impl_->context->make_current();
  impl_->surfaces.clear();
  impl_->models.clear();
  impl_->catchers.clear();
  impl_->environment.clear();
  impl_->software.clear();
  impl_->sun_shadow.forget();
}

std::map<std::string, double> Renderer::pass_times_ms() { return impl_->clock.take(); }

std::string Renderer::description() const {
  impl_->context->make_current();
  return reinterpret_cast<const char*>(impl_->gl.GetString(GL_VERSION));
}

}  // namespace planecast::render
