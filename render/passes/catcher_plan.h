#pragma once

#include <cstdint>
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

/// A patch of the scene that the camera sees getting darker.
struct PlannedCatcher {
  std::size_t patch = 0;   ///< number in the scene
  std::uint64_t hash = 0;  ///< of the patch's shape
  CatcherPlan plan;
};
std::vector<PlannedCatcher> plan_catchers(const LayerScene& scene, const Camera& camera,
                                          const std::vector<glm::vec3>& caster_points,
                                          bool sun_casts);

/// What the maps of a catcher are made from. `casters` changes when they or the sun do.
std::uint64_t map_signature(const PlannedCatcher& catcher, const LayerScene& scene,
                            std::uint64_t casters);

/// Texels along a side of a baked shadow: over a metre of table one is about a pixel.
inline constexpr int kBakedSide = 768;

/// Cells of the distance to a polygon's edge along its longer side.
inline constexpr int kMaskSide = 160;

/// Of a baked shadow over `region` (RGBA, as catcher.frag bakes) the part with shares that show
/// after rounding.
PlaneRegion dark_part(const ImageU8& baked, const PlaneRegion& region);

/// Texels of a shadow map that one of the penumbra map is the mean of, along a side: penumbrae are
/// wide.
int penumbra_factor(int shadow_map_size);

/// Tangent of the angle that the light is wide.
float light_tangent(const Sun& sun);

}  // namespace planecast::render
