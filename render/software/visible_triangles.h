#pragma once

#include <vector>

#include "render/passes/models.h"
#include "render/passes/targets.h"
#include "render/scene.h"
#include "render/software/object_surface.h"
#include "render/software/posed_meshes.h"
#include "render/software/sample_grid.h"

namespace planecast::render {

/// The triangles of a picture's items that face the right way and touch the window.
class VisibleTriangles {
 public:
  /// Meshes may be off by `detail_px` on the screen. Items and meshes must outlive the use.
  void collect(const std::vector<DrawItem>& items, const PosedMeshes& meshes, const Camera& camera,
               const Window& window, float detail_px);
  /// By the number that draw() gives them; number 0 is nothing.
  const std::vector<ObjectTriangle>& triangles() const { return triangles_; }
  const std::vector<ObjectSurface>& surfaces() const { return surfaces_; }
  void draw(SampleGrid& grid) const;

 private:
  void add_surface(const DrawItem& item, const PosedMesh& mesh,
                   const std::vector<ScreenVertex>& screen);
  void add_triangles(const DrawItem& item, const Camera& camera, const Window& window,
                     float detail_px);

  std::vector<std::vector<ScreenVertex>> screen_;  ///< by item
  std::vector<ObjectSurface> surfaces_;            ///< by item
  std::vector<ObjectTriangle> triangles_;
};

}  // namespace planecast::render
