#pragma once

#include <cstdint>
#include <span>

#include "render/gl/objects.h"
#include "render/vertex.h"

namespace planecast::render {

/// One indexed triangle list on the GPU. Attribute locations: 0 position, 1 normal, 2 tangent, 3
/// uv0, 4 uv1, 5 colour.
struct MeshBuffers {
  VertexArrayHandle vertex_array;
  BufferHandle shape;
  BufferHandle surface;
  BufferHandle indices;
  GLsizei index_count = 0;

  void draw(const Gl& gl) const;
};

MeshBuffers upload_mesh(const Gl& gl, std::span<const ShapeVertex> shape,
                        std::span<const SurfaceVertex> surface,
                        std::span<const std::uint32_t> indices);

/// A vertex array over a shape of its own and the surface and indices of `base`.
VertexArrayHandle make_deformed_array(const Gl& gl, const BufferHandle& shape,
                                      const MeshBuffers& base);

}  // namespace planecast::render
