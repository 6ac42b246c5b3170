#pragma once

#include <cstdint>
#include <vector>

#include "render/passes/models.h"
#include "render/software/object_surface.h"

namespace planecast::render {

/// Vertices of one item in the world.
struct PosedMesh {
  std::uint64_t signature = 0;  ///< of what they were made from
  std::vector<WorldVertex> vertices;
  bool colored = false;  ///< has colours other than white
};

/// The items of a frame in the world, each kept while it stands still.
class PosedMeshes {
 public:
  void update(const std::vector<DrawItem>& items);
  const PosedMesh& operator[](std::size_t item) const { return meshes_[item]; }
  void clear() { meshes_.clear(); }

 private:
  std::vector<PosedMesh> meshes_;
};

/// The triangles of an item whose mesh may be off by `error_m` in the world.
const std::vector<std::uint32_t>& triangles_of(const DrawItem& item, float error_m);

}  // namespace planecast::render
