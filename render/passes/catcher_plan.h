#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "render/passes/plane_frame.h"
#include "render/scene.h"

namespace planecast::render {

/// What the shadow on one patch consists of, before anything is drawn.
struct CatcherPlan {
  PlaneFrame frame;
  PlaneRegion region;             ///< what can get dark, within the polygon's bounds
  PlaneRegion contact_region;     ///< what the contact map covers; empty: no contact shadow
  float contact_reach_m = 0.0F;   ///< how far around the casters it is felt
  float contact_strength = 0.0F;  ///< 1 for casters on the plane, 0 for those well above it
  int contact_side = 0;           ///< texels of the contact map, a multiple of 4
  bool sun = false;               ///< the sun's shadow falls on this side of the plane
  float sun_share = 0.0F;         ///< of the plane's light when nothing is in the way
  float farthest_gap_m = 0.0F;    ///< longest way of the light from a caster to the plane
};

/// `caster_points` are corners of the casters' boxes in the world. Nothing for a patch that is not
/// drawable, is seen from behind, gets no light, lies above all casters or beyond their shadows.
std::optional<CatcherPlan> plan_catcher(const PlanePatch& patch,
                                        const std::vector<glm::vec3>& caster_points,
                                        const Light& light, bool sun_casts,
                                        const glm::vec3& camera_position);

}  // namespace planecast::render
