#include "render/gl/mesh_buffers.h"

#include <cstddef>

namespace planecast::render {
namespace {

constexpr GLuint kShapeBinding = 0;
constexpr GLuint kSurfaceBinding = 1;

void add_attribute(const Gl& gl, GLuint array, GLuint location, GLuint binding, GLint components,
                   std::size_t offset) {
  gl.EnableVertexArrayAttrib(array, location);
  gl.VertexArrayAttribFormat(array, location, components, GL_FLOAT, GL_FALSE,
                             static_cast<GLuint>(offset));
  gl.VertexArrayAttribBinding(array, location, binding);
}

VertexArrayHandle make_array(const Gl& gl, const BufferHandle& shape, const BufferHandle& surface,
                             const BufferHandle& indices) {
  VertexArrayHandle handle(gl);
  const GLuint array = handle.id();
  gl.VertexArrayVertexBuffer(array, kShapeBinding, shape.id(), 0, sizeof(ShapeVertex));
  gl.VertexArrayVertexBuffer(array, kSurfaceBinding, surface.id(), 0, sizeof(SurfaceVertex));
  gl.VertexArrayElementBuffer(array, indices.id());
  add_attribute(gl, array, 0, kShapeBinding, 3, offsetof(ShapeVertex, position));
  add_attribute(gl, array, 1, kShapeBinding, 3, offsetof(ShapeVertex, normal));
  add_attribute(gl, array, 2, kShapeBinding, 4, offsetof(ShapeVertex, tangent));
  add_attribute(gl, array, 3, kSurfaceBinding, 2, offsetof(SurfaceVertex, uv0));
  add_attribute(gl, array, 4, kSurfaceBinding, 2, offsetof(SurfaceVertex, uv1));
  add_attribute(gl, array, 5, kSurfaceBinding, 4, offsetof(SurfaceVertex, color));
  return handle;
}

}  // namespace

void MeshBuffers::draw(const Gl& gl) const {
  gl.BindVertexArray(vertex_array.id());
  gl.DrawElements(GL_TRIANGLES, levels.front().count, GL_UNSIGNED_INT, nullptr);
}

MeshBuffers upload_mesh(const Gl& gl, std::span<const ShapeVertex> shape,
                        std::span<const SurfaceVertex> surface,
                        std::span<const std::uint32_t> indices) {
  return upload_levels(gl, shape, surface, indices,
                       {{0, static_cast<GLsizei>(indices.size()), 0.0F}});
}

MeshBuffers upload_levels(const Gl& gl, std::span<const ShapeVertex> shape,
                          std::span<const SurfaceVertex> surface,
                          std::span<const std::uint32_t> indices, std::vector<IndexRange> levels) {
  MeshBuffers mesh;
  mesh.shape = BufferHandle(gl);
  mesh.surface = BufferHandle(gl);
  mesh.indices = BufferHandle(gl);
  upload(gl, mesh.shape, shape);
  upload(gl, mesh.surface, surface);
  upload(gl, mesh.indices, indices);
  mesh.levels = std::move(levels);
  mesh.vertex_array = make_array(gl, mesh.shape, mesh.surface, mesh.indices);
  return mesh;
}

VertexArrayHandle make_deformed_array(const Gl& gl, const BufferHandle& shape,
                                      const MeshBuffers& base) {
  return make_array(gl, shape, base.surface, base.indices);
}

}  // namespace planecast::render
