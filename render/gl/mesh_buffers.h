#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/gl/objects.h"
#include "render/vertex.h"

namespace planecast::render {

/// A range of an index buffer that draws a mesh, and how far it may be off the full one.
struct IndexRange {
  std::size_t first = 0;
  GLsizei count = 0;
  float error = 0.0F;  ///< in the shape's units
};

/// One indexed list of triangles, lines or points on the GPU. Attribute locations: 0 position, 1
/// normal, 2 tangent, 3 uv0, 4 uv1, 5 colour.
struct MeshBuffers {
  VertexArrayHandle vertex_array;
  BufferHandle shape;
  BufferHandle surface;
  BufferHandle indices;
  std::vector<IndexRange> levels;  ///< the full mesh, then ever coarser ones

  void draw(const Gl& gl) const;
};

MeshBuffers upload_mesh(const Gl& gl, std::span<const ShapeVertex> shape,
                        std::span<const SurfaceVertex> surface,
                        std::span<const std::uint32_t> indices);

/// Joined index lists become the levels; `levels` are the first places, counts and errors in them.
MeshBuffers upload_levels(const Gl& gl, std::span<const ShapeVertex> shape,
                          std::span<const SurfaceVertex> surface,
                          std::span<const std::uint32_t> indices, std::vector<IndexRange> levels);

/// A vertex array over a shape of its own and the surface and indices of `base`.
VertexArrayHandle make_deformed_array(const Gl& gl, const BufferHandle& shape,
                                      const MeshBuffers& base);

}  // namespace planecast::render
