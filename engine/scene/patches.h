#pragma once

#include <vector>

#include "engine/pipeline/reconstruction.h"
#include "engine/scene/content.h"
#include "engine/scene/plane_outline.h"
#include "render/scene.h"

namespace planecast::engine {

/// The polygon united with a circle: an estimated outline ends at the last landmark, but where
/// content stands there is surface. On a grid of `cells` to the longer side; the polygon itself
/// when it holds the circle. What comes out is one ring (with holes) in the plane's frame.
PlaneOutline with_circle(const PlaneOutline& outline, const Eigen::Vector2d& centre, double radius,
                         int cells = 384);

/// Shadow catchers: the planes that content stands on, each once, and a patch of ground under
/// content that is tied to no plane.
std::vector<render::PlanePatch> shadow_catchers(const Reconstruction& reconstruction,
                                                const Content& content);

struct OccluderOptions {
  int min_inliers = 40;           ///< planes with less support hide nothing
  double max_rms_share = 0.01;    ///< of the median depth
  double set_back_share = 0.015;  ///< occluders stand back by this share of the median depth
  double near_plane_share =
      0.5;  ///< planes nearly in the content's own plane: closer than this x size
};

/// Planes that hide content behind them. A wrong occluder cuts holes into objects and a missing one
/// is hardly seen, so only planes with sound support take part, none that content stands on or that
/// runs nearly in one of those, and each is moved back a little along its normal.
std::vector<render::PlanePatch> plane_occluders(const Reconstruction& reconstruction,
                                                const Content& content,
                                                const OccluderOptions& options = {});

}  // namespace planecast::engine
