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

/// A patch of the finished map and the plane that it belongs to (kNone: the world).
struct MapPatch {
  int plane_id = slam::kNone;
  render::PlanePatch patch;
};

/// What makes a plane worth trusting beyond the content that stands on it.
struct SoundPlane {
  int min_inliers = 40;         ///< planes with less support do not count
  double max_rms_share = 0.01;  ///< of the median depth
};

struct CatcherOptions {
  SoundPlane sound;
  double reach = 2.5;  ///< sizes of the content within which its shadow falls on other planes
  double near_plane_share = 0.5;  ///< planes nearly in the content's own: closer than this x size
};

/// Shadow catchers: the planes that content stands on, each once; sound planes near it, such as the
/// wall behind a table, which it stands in front of and which its own plane does not shield; and a
/// patch of ground under content that is tied to no plane.
std::vector<MapPatch> shadow_catchers(const Reconstruction& reconstruction, const Content& content,
                                      const CatcherOptions& options = {});

struct OccluderOptions {
  SoundPlane sound;
  double set_back_share = 0.015;  ///< occluders stand back by this share of the median depth
  double near_plane_share =
      0.5;  ///< planes nearly in the content's own plane: closer than this x size
};

/// Planes that hide content behind them. A wrong occluder cuts holes into objects and a missing one
/// is hardly seen, so only planes with sound support take part, none that content stands on or that
/// runs nearly in one of those, and each is moved back a little along its normal.
std::vector<MapPatch> plane_occluders(const Reconstruction& reconstruction, const Content& content,
                                      const OccluderOptions& options = {});

}  // namespace planecast::engine
