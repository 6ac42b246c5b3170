#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "engine/sequence/synth/room_model.h"

namespace planecast::engine::synth {

struct RayHit {
  float distance = 0.0F;
  int patch = -1;  ///< -1: nothing within reach
};

/// Rays against the patches that cast shadows; a binary tree of boxes over their triangles.
class RayCaster {
 public:
  explicit RayCaster(const RoomModel& model);

  /// Nearest hit within `reach`.
  RayHit nearest(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction,
                 float reach) const;
  bool blocked(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float reach) const;

 private:
  struct Triangle {
    Eigen::Vector3f corner, edge_a, edge_b;
    int patch;
  };
  struct Node {
    Eigen::Vector3f low, high;
    int first = 0;  ///< of its triangles, or its first child (the second follows)
    int count = 0;  ///< 0: inner node
  };
  template <bool any_hit>
  RayHit trace(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float reach) const;

  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;
};

}  // namespace planecast::engine::synth
