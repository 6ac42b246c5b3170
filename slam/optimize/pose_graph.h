#pragma once

#include <vector>

#include "slam/geometry/sim3.h"

namespace planecast::slam {

/// A camera of the graph. Its scale turns map units into the units in which its edges were
/// measured.
struct PoseGraphNode {
  Similarity cam_from_world;
  bool fixed = false;
};

/// That camera `to` sees camera `from` at to_from_from.
struct PoseGraphEdge {
  int from = 0;  ///< index into the nodes
  int to = 0;
  Similarity to_from_from;
  double weight = 1.0;
};

struct PoseGraphOptions {
  bool with_scale = true;  ///< 7 degrees of freedom (mono); false: 6 (RGB-D)
  int iterations = 50;
  /// Length in map units that counts as much as a radian or a factor e in scale: what the cameras
  /// look at lies about so far away, so that all three move its image alike.
  double length = 1.0;
};

struct PoseGraphResult {
  double cost_before = 0.0;
  double cost_after = 0.0;
  int iterations = 0;
};

/// Least squares over the edges (Strasdat et al., RSS 2010) by Levenberg-Marquardt with analytic
/// Jacobians and one thread; the same bytes for the same graph. At least one node must be fixed and
/// the graph connected, or parts of it stay where they are.
PoseGraphResult solve_pose_graph(std::vector<PoseGraphNode>& nodes,
                                 const std::vector<PoseGraphEdge>& edges,
                                 const PoseGraphOptions& options);

}  // namespace planecast::slam
