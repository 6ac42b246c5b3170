#include "render/passes/occluders.h"

#include <glm/gtc/matrix_transform.hpp>

#include "render/passes/plane_frame.h"
#include "render/passes/view.h"

namespace planecast::render {
OccluderPass::OccluderPass(const Gl& gl) : gl_(&gl), points_(gl), vertex_array_(gl) {
  const GLuint array = vertex_array_.id();
  gl.VertexArrayVertexBuffer(array, 0, points_.id(), 0, sizeof(glm::vec3));
  gl.EnableVertexArrayAttrib(array, 0);
  gl.VertexArrayAttribFormat(array, 0, 3, GL_FLOAT, GL_FALSE, 0);
  gl.VertexArrayAttribBinding(array, 0, 0);
}

void OccluderPass::load(const std::vector<glm::vec3>& points) {
  upload(*gl_, points_, std::span<const glm::vec3>(points), GL_STREAM_DRAW);
}

void OccluderPass::draw(ShaderLibrary& shaders, const std::vector<PlanePatch>& occluders,
                        const Camera& camera) {
  if (occluders.empty()) return;
  const Program& program = shaders.get("occluder.vert", "occluder.frag");
  program.use();
  const glm::mat4 retreat = glm::scale(glm::mat4(1.0F), glm::vec3(1.0F + kOccluderRetreat));
  program.set("u_clip_from_world", clip_from_camera(camera) * retreat * camera.camera_from_world);
  gl_->BindVertexArray(vertex_array_.id());
  gl_->ColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  gl_->Disable(GL_CULL_FACE);
  gl_->Disable(GL_BLEND);
  gl_->Enable(GL_STENCIL_TEST);
  for (const PlanePatch& patch : occluders) {
    if (!drawable(patch)) continue;
    const PlaneFrame frame = plane_frame(patch);

    gl_->DepthMask(GL_FALSE);
    gl_->DepthFunc(GL_ALWAYS);
    gl_->StencilFunc(GL_ALWAYS, 0, 1);
    gl_->StencilOp(GL_KEEP, GL_INVERT, GL_INVERT);
    const auto invert_ring = [&](const std::vector<glm::vec3>& ring) {
      if (ring.size() < 3) return;
      load(ring);
      gl_->DrawArrays(GL_TRIANGLE_FAN, 0, static_cast<GLsizei>(ring.size()));
    };
    invert_ring(patch.outer);
    for (const auto& hole : patch.holes) invert_ring(hole);

    gl_->DepthMask(GL_TRUE);
    gl_->DepthFunc(GL_GREATER);
    gl_->StencilFunc(GL_EQUAL, 1, 1);
    gl_->StencilOp(GL_KEEP, GL_ZERO, GL_ZERO);
    load(frame.corners(outer_region(patch, frame)));
    gl_->DrawArrays(GL_TRIANGLE_FAN, 0, 4);
  }
  gl_->Disable(GL_STENCIL_TEST);
  gl_->ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

}  // namespace planecast::render
