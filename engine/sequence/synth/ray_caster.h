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

    Eigen::Vector3f low() const;
    Eigen::Vector3f high() const;
    Eigen::Vector3f middle() const;
  };
  struct Node {
    Eigen::Array4f low, high;  ///< the fourth lane is 0
    int first = 0;             ///< of its triangles, or its first child (the second follows)
    int count = 0;             ///< 0: inner node
  };
  int split(int first, int count, Node& node);
  template <bool any_hit>
  RayHit trace(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float reach) const;

  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;
};

}  // namespace planecast::engine::synth
