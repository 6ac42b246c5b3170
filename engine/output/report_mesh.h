#pragma once

#include <cstdint>
#include <vector>

#include "render/scene.h"

namespace planecast::engine {

/// A model as triangles of coloured vertices in its own space: enough for a small picture of it.
struct ReportMesh {
  std::vector<float> positions;           ///< x, y, z a vertex
  std::vector<std::uint8_t> colors_srgb;  ///< r, g, b a vertex
  std::vector<std::uint32_t> triangles;   ///< three vertices each
};

/// The rest pose, each primitive at the level of detail that has at most its share of
/// `max_triangles`; colours are the base colour map's at the vertices. Empty where even the
/// coarsest levels have too many triangles.
ReportMesh report_mesh(const render::Model& model, std::size_t max_triangles = 6000);

}  // namespace planecast::engine
