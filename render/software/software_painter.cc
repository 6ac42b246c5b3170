#include "render/software/software_painter.h"

#include "render/passes/model_passes.h"
#include "render/passes/occluders.h"
#include "render/passes/sun_shadow.h"
#include "render/passes/view.h"
#include "render/software/software_input.h"

namespace planecast::render {

SoftwarePainter::SoftwarePainter(int shadow_map_size, float detail_px)
    : detail_px_(detail_px), sun_(shadow_map_size) {}

const SunMap* SoftwarePainter::update_sun(const Sun& sun, const PosedItems& posed) {
  if (!casts(sun)) return nullptr;
  if (sun_signature_ != posed.signature) {
    sun_signature_ = posed.signature;
    sun_.draw(fit_sun(sun, *posed.points, sun_.size()), *posed.items, meshes_, detail_px_);
  }
  return &sun_;
}

void SoftwarePainter::draw(const LayerScene& scene, const Camera& camera, const PosedItems& posed,
                           PassClock& clock, Layer& layer) {
  meshes_.update(*posed.items);
  clock.end_of("vertices");
  const SunMap* sun = update_sun(scene.light.sun, posed);
  clock.end_of("sun's shadow map");
  catchers_.prepare(
      scene, camera,
      {posed.items, &meshes_, posed.points, sun, posed.signature, posed.still, detail_px_});
  clock.end_of("catcher maps");
  layer.bounds = layer_bounds(camera, *posed.points, catchers_.touched_points());
  if (layer.bounds.width == 0) return;
  SoftwareInput input;
  input.scene = &scene;
  input.camera = &camera;
  input.items = posed.items;
  input.meshes = &meshes_;
  input.shadows = &catchers_.shadows();
  input.shading.light = light_uniforms(scene, camera, sun);
  input.shading.shadow = shadow_texels(scene.light.sun, sun);
  input.shading.reflections = environment_.reflections(scene.light);
  input.shading.occlusion = depth_occlusion(scene, camera, kOccluderTolerance);
  input.shading.corner = {layer.bounds.x, layer.bounds.y};
  input.shading.view_depth = glm::transpose(camera.camera_from_world)[2];
  input.plane_occlusion = depth_occlusion(scene, camera, kCatcherTolerance * kOccluderTolerance);
  input.detail_px = detail_px_;
  layer_.draw(input, {camera.width, camera.height, layer.bounds}, clock, layer);
  layer.by_processor = true;
}

void SoftwarePainter::clear() {
  meshes_.clear();
  catchers_.clear();
  environment_.clear();
  sun_signature_ = 0;
}

}  // namespace planecast::render
