#pragma once

#include "render/gltf/model.h"

namespace planecast::render {

/// Gathers all streams of `primitive` so that new vertex i is old vertex source[i]; indices
/// untouched.
void gather_vertices(Primitive& primitive, const std::vector<std::uint32_t>& source);

/// Sets the normals of vertices that belong to triangles by threes.
void set_flat_normals(std::vector<ShapeVertex>& shape);

/// Gives every triangle its own vertices with the face's normal (glTF 2.0, 3.7.2.1: flat normals
/// where a file has none). Morph targets keep their positions and lose their normals.
void add_flat_normals(Primitive& primitive);

/// Tangents along +u of coordinate set `uv_set`, averaged over a vertex's triangles by angle. Where
/// the texture is mirrored on one side, the vertex is split. Needs normals.
void add_tangents(Primitive& primitive, int uv_set);

}  // namespace planecast::render
