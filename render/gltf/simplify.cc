#include "render/gltf/simplify.h"

#include <meshoptimizer.h>

#include <cmath>

namespace planecast::render {
namespace {

/// Fewer triangles cost less than the pixels they cover.
constexpr std::size_t kSmallestIndexCount = 3 * 500;
constexpr int kMostLevels = 8;
/// A level must save this share of the one before to be worth its memory.
constexpr double kWorthwhile = 0.8;
/// Of the mesh's extent: what is coarser is never near enough to half a pixel.
constexpr float kLargestError = 0.1F;

bool deformable(const Primitive& primitive) {
  return !primitive.targets.empty() || !primitive.joints.empty();
}

}  // namespace

void add_detail_levels(Primitive& primitive) {
  const std::size_t count = primitive.indices.size();
  if (primitive.topology != Topology::kTriangles || count < kSmallestIndexCount) return;
  const std::size_t vertices = primitive.shape.size();
  meshopt_optimizeVertexCache(primitive.indices.data(), primitive.indices.data(), count, vertices);
  if (deformable(primitive)) return;
  const float* positions = &primitive.shape.front().position.x;
  const float scale = meshopt_simplifyScale(positions, vertices, sizeof(ShapeVertex));
  std::size_t previous = count;
  for (int i = 1; i <= kMostLevels && (count >> i) >= kSmallestIndexCount / 4; ++i) {
    DetailLevel level;
    level.indices.resize(count);
    float error = 0.0F;
    const std::size_t target = (count >> i) / 3 * 3;
    level.indices.resize(meshopt_simplify(level.indices.data(), primitive.indices.data(), count,
                                          positions, vertices, sizeof(ShapeVertex), target,
                                          kLargestError, 0, &error));
    const std::size_t now = level.indices.size();
    if (now == 0 || static_cast<double>(now) > kWorthwhile * static_cast<double>(previous)) return;
    meshopt_optimizeVertexCache(level.indices.data(), level.indices.data(), now, vertices);
    level.error = error * scale;
    primitive.details.push_back(std::move(level));
    previous = now;
  }
}

}  // namespace planecast::render
