#include "render/passes/catcher_plan.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/passes/content_hash.h"
#include "render/passes/view.h"

namespace planecast::render {
namespace {

/// Texels of a contact map for an object as wide as high, and at most; multiples of the 4 x 4
/// pattern.
constexpr int kContactSide = 144;
constexpr int kLargestContactSide = 288;
/// How far a contact shadow reaches, in heights of the object: there a wall hides 1 / (1 + 1.5^2)
/// of a direction's light, a column much less, and the rest fades out.
constexpr float kContactReach = 1.5F;
/// Below this cosine the sun grazes the plane and its shadow is endless.
constexpr float kSmallestCosine = 0.03F;

float luminance(const glm::vec3& color) {
  return glm::dot(color, glm::vec3(0.2126F, 0.7152F, 0.0722F));
}

/// Irradiance / pi on a plane from the surroundings; as diffuse_ambient in ambient.glsl.
glm::vec3 ambient_on(const std::array<glm::vec3, 9>& sh, const glm::vec3& n) {
  glm::vec3 sum = 0.282095F * sh[0];
  sum += 2.0F / 3.0F * 0.488603F * (n.y * sh[1] + n.z * sh[2] + n.x * sh[3]);
  sum += 0.25F * (1.092548F * (n.x * n.y * sh[4] + n.y * n.z * sh[5] + n.x * n.z * sh[7]) +
                  0.315392F * (3.0F * n.z * n.z - 1.0F) * sh[6] +
                  0.546274F * (n.x * n.x - n.y * n.y) * sh[8]);
  return glm::max(sum, glm::vec3(0.0F));
}

/// The casters as a plane sees them.
struct Silhouette {
  PlaneRegion footprint = nothing();
  float top = 0.0F;
  float underside = 0.0F;
};

Silhouette silhouette_of(const std::vector<glm::vec3>& points, const PlaneFrame& frame) {
  Silhouette found;
  found.top = -1e30F;
  found.underside = 1e30F;
  for (const glm::vec3& point : points) {
    const float height = frame.height(point);
    found.footprint.add(frame.coordinates(point));
    found.top = std::max(found.top, height);
    found.underside = std::min(found.underside, height);
  }
  return found;
}

/// Objects far off a plane, measured in their own width, leave hardly a trace on it: faded out, so
/// that it need not be computed.
float contact_strength(float lift) {
  constexpr float kFull = 0.25F;
  constexpr float kNone = 0.5F;
  return std::clamp((kNone - lift) / (kNone - kFull), 0.0F, 1.0F);
}

/// Objects spread over a plane need more texels than one.
int contact_side(const PlaneRegion& region, float reach_m) {
  const glm::vec2 size = region.size();
  constexpr float kRegionOfOne = (1.0F + 2.0F * kContactReach) / kContactReach;
  const float ones = std::max(size.x, size.y) / (kRegionOfOne * reach_m);
  const float side =
      std::clamp(static_cast<float>(kContactSide) * ones, static_cast<float>(kContactSide),
                 static_cast<float>(kLargestContactSide));
  return static_cast<int>(side) / 4 * 4;
}

/// Where the sun's shadow of the points can fall.
PlaneRegion sun_region(const std::vector<glm::vec3>& points, const PlaneFrame& frame,
                       const glm::vec3& to_light, float angular_radius) {
  const float cosine = glm::dot(frame.normal, to_light);
  const glm::vec2 slope =
      glm::vec2(glm::dot(frame.x, to_light), glm::dot(frame.y, to_light)) / cosine;
  PlaneRegion region = nothing();
  for (const glm::vec3& point : points) {
    const float height = std::max(frame.height(point), 0.0F);
    const glm::vec2 falls = frame.coordinates(point) - slope * height;
    const glm::vec2 blur(height * angular_radius / (cosine * cosine));
    region.add(falls - blur);
    region.add(falls + blur);
  }
  return region;
}

std::uint64_t patch_hash(const PlanePatch& patch) {
  ContentHash hash;
  hash.add(patch.normal);
  hash.add(patch.outer);
  for (const auto& hole : patch.holes) hash.add(hole);
  return hash.value();
}

PlaneRegion united(const PlaneRegion& a, const PlaneRegion& b) {
  return {glm::min(a.min, b.min), glm::max(a.max, b.max)};
}

}  // namespace

std::optional<CatcherPlan> plan_catcher(const PlanePatch& patch,
                                        const std::vector<glm::vec3>& caster_points,
                                        const Light& light, bool sun_casts,
                                        const glm::vec3& camera_position) {
  if (!drawable(patch) || caster_points.empty()) return std::nullopt;
  CatcherPlan plan;
  plan.frame = plane_frame(patch);
  if (plan.frame.height(camera_position) <= 0.0F) return std::nullopt;
  const Silhouette casters = silhouette_of(caster_points, plan.frame);
  if (casters.top <= 0.0F) return std::nullopt;

  const glm::vec3 to_light = glm::normalize(light.sun.direction_to_light);
  const float cosine = glm::dot(plan.frame.normal, to_light);
  const float ambient = luminance(ambient_on(light.ambient_sh, plan.frame.normal));
  const float sun = luminance(light.sun.radiance) * std::max(cosine, 0.0F);
  if (!(ambient + sun > 0.0F)) return std::nullopt;
  plan.sun_share = sun / (ambient + sun);
  plan.sun = sun_casts && cosine > kSmallestCosine;
  plan.farthest_gap_m = casters.top / std::max(cosine, kSmallestCosine);

  PlaneRegion touched = nothing();
  const PlaneRegion outer = outer_region(patch, plan.frame);
  const glm::vec2 width = casters.footprint.size();
  plan.contact_reach_m = kContactReach * casters.top;
  plan.contact_strength = contact_strength(casters.underside / std::max(width.x, width.y));
  plan.contact_region = nothing();
  if (ambient > 0.0F && plan.contact_strength > 0.0F) {
    const PlaneRegion around = {casters.footprint.min - plan.contact_reach_m,
                                casters.footprint.max + plan.contact_reach_m};
    if (!intersection(outer, around).empty()) {
      plan.contact_region = touched = around;
      plan.contact_side = contact_side(around, plan.contact_reach_m);
    }
  }
  if (plan.sun) {
    touched = united(touched,
                     sun_region(caster_points, plan.frame, to_light, light.sun.angular_radius_rad));
  }
  plan.region = intersection(outer, touched);
  if (plan.region.empty()) return std::nullopt;
  return plan;
}

std::vector<PlannedCatcher> plan_catchers(const LayerScene& scene, const Camera& camera,
                                          const std::vector<glm::vec3>& caster_points,
                                          bool sun_casts) {
  std::vector<PlannedCatcher> planned;
  const glm::vec3 eye = camera_position(camera);
  for (std::size_t i = 0; i < scene.catchers.size(); ++i) {
    const auto plan = plan_catcher(scene.catchers[i], caster_points, scene.light, sun_casts, eye);
    if (!plan) continue;
    if (projected_bounds(camera, plan->frame.corners(plan->region)).width == 0) continue;
    planned.push_back({i, patch_hash(scene.catchers[i]), *plan});
  }
  return planned;
}

std::uint64_t map_signature(const PlannedCatcher& catcher, const LayerScene& scene,
                            std::uint64_t casters) {
  ContentHash signature;
  signature.add(casters);
  signature.add(catcher.hash);
  signature.add(catcher.plan.sun);
  signature.add(catcher.plan.contact_region.empty());
  signature.add(scene.light.sun.angular_radius_rad);
  signature.add(scene.catchers[catcher.patch].edge_softness_m);
  return signature.value();
}

PlaneRegion dark_part(const ImageU8& baked, const PlaneRegion& region) {
  constexpr std::uint8_t kVisible = 2;
  const auto side = static_cast<std::size_t>(baked.width);
  const glm::vec2 texel = region.size() / static_cast<float>(baked.width);
  PlaneRegion dark = nothing();
  for (std::size_t y = 0; y < side; ++y) {
    for (std::size_t x = 0; x < side; ++x) {
      const std::uint8_t* at = &baked.pixels[4 * (y * side + x)];
      if (std::max(at[0], at[1]) < kVisible || at[2] == 0) continue;
      const glm::vec2 corner(static_cast<float>(x), static_cast<float>(y));
      dark.add(region.min + (corner - 1.0F) * texel);
      dark.add(region.min + (corner + 2.0F) * texel);
    }
  }
  return intersection(dark, region);
}

int penumbra_factor(int shadow_map_size) {
  constexpr int kPenumbraSide = 512;
  return std::max(1, shadow_map_size / kPenumbraSide);
}

float light_tangent(const Sun& sun) {
  return std::tan(std::clamp(sun.angular_radius_rad, 0.0F, 0.5F));
}

}  // namespace planecast::render
