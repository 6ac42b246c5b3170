#pragma once

#include "render/gltf/model.h"

namespace planecast::render {

/// Whether a fair part of the model reflects its surroundings so sharply that they can be made out:
/// smooth metal, or anything nearly a mirror.
bool is_polished(const Model& model);

}  // namespace planecast::render
