#pragma once

#include <memory>

#include "render/gltf/model.h"
#include "render/scene.h"

namespace planecast::bench {

/// A bumpy ball with about `triangles` triangles, colour, normal and roughness maps of 1024 x 1024,
/// standing on y = 0; radius about 0.15 m.
std::shared_ptr<const render::Model> bumpy_ball(int triangles);

/// The ball on a table of one metre under a sun: what a frame of an augmented video draws.
render::LayerScene table_scene(const std::shared_ptr<const render::Model>& model);

/// A 640x480 camera that goes round the table; the ball covers about a tenth of the picture.
render::Camera camera_at(int frame);

}  // namespace planecast::bench
