#pragma once

#include "engine/sequence/synth/light_bake.h"
#include "engine/sequence/synth/room_model.h"
#include "render/scene.h"

namespace planecast::engine::synth {

/// Paints reflectance and baked light into textures: the renderer then has nothing to light. The
/// world stays z up. `detail` scales the textures: 1 is right for pictures 640 wide. Takes seconds
/// at 1; two threads, the same bytes.
render::OpaqueScene paint_scene(const RoomModel& model, float detail);

}  // namespace planecast::engine::synth
