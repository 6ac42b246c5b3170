#pragma once

#include <vector>

#include "render/gltf/model.h"

namespace planecast::render {

/// Ever coarser versions of a primitive's triangles by quadric error (Garland and Heckbert 1997, as
/// meshoptimizer has it), each about half as many as the one before; borders and seams of the
/// attributes stay closed. Empty for what deforms, is no surface or is small already. Orders the
/// primitive's own triangles for the vertex cache, too.
void add_detail_levels(Primitive& primitive);

}  // namespace planecast::render
