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
#include "render/passes/surfaces.h"
#include "render/passes/targets.h"
#include "render/passes/view.h"
#include "render/software/software_layer.h"

namespace planecast::render {
namespace {

constexpr float kSqrt4Pi = 3.5449077F;
/// A shadow's plane was fitted to the same depths that occlude it, so it gets more leeway.
constexpr float kCatcherTolerance = 2.5F;
/// Pixels around the projected bounds: one for the resolve, one for rounding.
constexpr int kBoundsMargin = 2;

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

int power_of_two(int size) { return static_cast<int>(std::bit_floor(static_cast<unsigned>(size))); }

bool casts(const Sun& sun) { return sun.casts_shadow && sun.radiance != glm::vec3(0.0F); }

/// Whether the shadows are the same in every frame. Told by the scene, not by the last frame, so
/// that a picture never depends on those drawn before it.
bool stands_still(const LayerScene& scene) {
  return std::ranges::all_of(scene.instances, [](const Instance& instance) {
    return instance.model == nullptr || instance.animation < 0 ||
           static_cast<std::size_t>(instance.animation) >= instance.model->animations.size();
  });
}

float shadow_margin_texels(const Sun& sun) { return 3.0F + 2.0F * sun.softness; }

/// What the shadows of a frame depend on, except the planes they fall on.
std::uint64_t caster_signature(const ModelSet& models, const Sun& sun) {
  ContentHash hash;
  hash.add(models.signature());
  hash.add(sun.direction_to_light);
  hash.add(sun.softness);
  hash.add(casts(sun));
  return hash.value();
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
        shadow_map(gl, power_of_two(std::clamp(given.shadow_map_size, 64, 8192))),
        surfaces(gl),
        models(gl),
        model_passes(gl, shaders, models),
        catchers(gl, model_passes),
        occluders(gl),
        environment(gl) {
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
  void draw_by_opengl(const LayerScene& scene, const Camera& camera, const CatcherInput& catching,
                      const Window& window, Layer& layer);
  void draw_by_processor(const CatcherInput& catching, const Window& window, Layer& layer);
  void draw_layer_color(const LayerScene& scene, const Camera& camera, const CatcherInput& catching,
                        const ShadingInput& shading, const Window& window, Layer& layer);
  OpaqueImages draw_opaque(const OpaqueScene& scene, const Camera& camera);
  void draw_shadow_map(const ShadowProjection& projection, const std::vector<DrawItem>& items,
                       const Sun& sun, bool with_surfaces, std::uint64_t signature);
  GLuint upload_occluder_depth(const LayerScene& scene, const Window& window);
  void light_by(const Light& light, ShadingInput& shading);
  void begin_opaque_state() const;
  void check_errors() const;

  RendererOptions options;
  std::unique_ptr<GlContext> context;
  Gl gl;
  ShaderLibrary shaders;
  ShadowMap shadow_map;
  std::uint64_t shadow_signature = 0;
  std::vector<float> shadow_in_memory;  ///< of the map as it is, or empty
  SurfaceSet surfaces;
  ModelSet models;
  ModelPasses model_passes;
  CatcherPass catchers;
  OccluderPass occluders;
  EnvironmentMap environment;
  SoftwareLayer software;
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

void Renderer::Impl::draw_shadow_map(const ShadowProjection& projection,
                                     const std::vector<DrawItem>& items, const Sun& sun,
                                     bool with_surfaces, std::uint64_t signature) {
  if (signature == shadow_signature) return;
  shadow_signature = signature;
  shadow_in_memory.clear();
  shadow_map.begin(projection);
  // Casters step back by their slope, so that they do not shade themselves between texels.
  constexpr float kSlopeTexels = 1.5F;
  gl.Enable(GL_POLYGON_OFFSET_FILL);
  gl.PolygonOffset(kSlopeTexels, 0.0F);
  if (with_surfaces) {
    surfaces.draw_shadow(shaders, projection, glm::normalize(sun.direction_to_light));
  }
  model_passes.draw_depth(items, projection.clip_from_world,
                          options.simplify_px * projection.texel_m);
  gl.Disable(GL_POLYGON_OFFSET_FILL);
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
  const Sun& sun = scene.light.sun;
  const std::uint64_t signature = caster_signature(models, sun);
  const ShadowMap* shadow = nullptr;
  if (casts(sun)) {
    draw_shadow_map(
        fit_shadow(sun.direction_to_light, points, shadow_map.size(), shadow_margin_texels(sun)),
        items, sun, false, signature);
    shadow = &shadow_map;
  }
  CatcherInput catching;
  catching.scene = &scene;
  catching.camera = &camera;
  catching.items = &items;
  catching.caster_points = &points;
  catching.shadow = shadow;
  catching.casters = signature;
  catching.still = stands_still(scene);
  catching.detail_texels = options.simplify_px;
  catchers.prepare(shaders, catching);
  clock.end_of("catcher maps");

  Layer::Rect bounds;
  for (std::size_t i = 0; i < points.size(); i += 8) {
    const auto first = points.begin() + static_cast<std::ptrdiff_t>(i);
    bounds = united(bounds, projected_bounds(camera, {first, first + 8}));
  }
  const std::vector<glm::vec3> dark = catchers.touched_points(catching);
  for (std::size_t i = 0; i < dark.size(); i += 4) {
    const auto first = dark.begin() + static_cast<std::ptrdiff_t>(i);
    bounds = united(bounds, projected_bounds(camera, {first, first + 4}));
  }
  layer.bounds = grown(bounds, kBoundsMargin, camera);
  if (layer.bounds.width == 0) return layer;

  const Window window{camera.width, camera.height, layer.bounds};
  const bool by_processor =
      !options.only_opengl && options.msaa_samples > 1 &&
      SoftwareLayer::can_draw(scene, camera, items, !models.lamps().empty(), catching.still);
  if (by_processor) {
    draw_by_processor(catching, window, layer);
    layer.by_processor = true;
  } else {
    draw_by_opengl(scene, camera, catching, window, layer);
  }
  check_errors();
  return layer;
}

void Renderer::Impl::draw_by_processor(const CatcherInput& catching, const Window& window,
                                       Layer& layer) {
  const LayerScene& scene = *catching.scene;
  const Sun& sun = scene.light.sun;
  SoftwareInput input;
  input.scene = &scene;
  input.camera = catching.camera;
  input.items = catching.items;
  input.shadows = &catchers.shadows_in_memory();
  input.detail_px = options.simplify_px;
  input.light.eye = camera_position(*catching.camera);
  input.light.ambient_sh = scene.light.ambient_sh;
  input.light.to_light = glm::normalize(sun.direction_to_light);
  input.light.sun = sun.radiance;
  input.light.exposure = scene.exposure;
  if (catching.shadow != nullptr) {
    if (shadow_in_memory.empty()) shadow_in_memory = shadow_map.read();
    const ShadowProjection& projection = shadow_map.projection();
    const float radius_m = sun.softness * projection.texel_m;
    input.light.shadow_from_world = projection.clip_from_world;
    input.light.shadow_reach_m = 1.5F * projection.texel_m + radius_m;
    input.light.shadow_bias = 0.5F * projection.texel_m / projection.depth_m;
    input.shadow = {shadow_in_memory.data(), shadow_map.size(),
                    glm::vec2(0.9F, 0.35F) * (radius_m / projection.extent_m)};
  }
  software.draw(input, window, layer);
  clock.end_of("objects by the processor");
}

void Renderer::Impl::draw_by_opengl(const LayerScene& scene, const Camera& camera,
                                    const CatcherInput& catching, const Window& window,
                                    Layer& layer) {
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
  const ShadowMap* shadow = nullptr;
  if (casts(sun)) {
    std::vector<glm::vec3> points = world_box_points(items);
    points.insert(points.end(), surfaces.box_points().begin(), surfaces.box_points().end());
    ContentHash signature;
    signature.add(caster_signature(models, sun));
    signature.add(surfaces.signature());
    draw_shadow_map(
        fit_shadow(sun.direction_to_light, points, shadow_map.size(), shadow_margin_texels(sun)),
        items, sun, true, signature.value());
    shadow = &shadow_map;
  }

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
  impl_->shadow_signature = 0;
}

std::map<std::string, double> Renderer::pass_times_ms() { return impl_->clock.take(); }

std::string Renderer::description() const {
  impl_->context->make_current();
  return reinterpret_cast<const char*>(impl_->gl.GetString(GL_VERSION));
}

}  // namespace planecast::render
