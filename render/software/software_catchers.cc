#include "render/software/software_catchers.h"

#include <algorithm>
#include <cmath>

#include "render/mip_levels.h"
#include "render/passes/content_hash.h"

namespace planecast::render {
namespace {

/// A region's points onto the texels of an image that covers it.
PlaneImage image_over(const ImageF& image, const PlaneRegion& region) {
  const glm::vec2 size(static_cast<float>(image.width), static_cast<float>(image.height));
  const glm::vec2 scale = size / region.size();
  return {&image, scale, -region.min * scale - 0.5F};
}

void set_sun(const SunMap& sun, const PenumbraMap& penumbra, const Light& light,
             const CatcherPlan& plan, CatcherMaps& maps) {
  const ShadowProjection& projection = sun.projection();
  const auto share_of = [&](const glm::vec4& world) {
    return 0.5F * glm::vec2(projection.clip_from_world * world);
  };
  maps.penumbra = &penumbra.levels();
  maps.sun_from_plane =
      glm::mat3x2(share_of(glm::vec4(plan.frame.x, 0.0F)), share_of(glm::vec4(plan.frame.y, 0.0F)),
                  share_of(glm::vec4(plan.frame.origin, 1.0F)) + 0.5F);
  maps.penumbra_texel_m = projection.texel_m * static_cast<float>(penumbra_factor(sun.size()));
  maps.penumbra_extent_m = projection.extent_m;
  maps.light_tangent = light_tangent(light.sun);
  maps.farthest_gap_m = plan.farthest_gap_m;
  maps.smallest_radius_m = light.sun.softness * projection.texel_m;
}

std::uint8_t byte_of(float share) {
  return static_cast<std::uint8_t>(255.0F * std::clamp(share, 0.0F, 1.0F) + 0.5F);
}

ImageU8 bake(const CatcherMaps& maps, const PlaneRegion& region) {
  ImageU8 baked(kBakedSide, kBakedSide, 4);
  const glm::vec2 texel = region.size() / static_cast<float>(kBakedSide);
  TextureReads found;
  Lane x;
  Lane y;
  std::size_t at = 0;
  for (int row = 0; row < kBakedSide; ++row) {
    y.fill(region.min.y + (static_cast<float>(row) + 0.5F) * texel.y);
    for (int first = 0; first < kBakedSide; first += static_cast<int>(kLanes)) {
      for (std::size_t i = 0; i < kLanes; ++i) {
        x[i] = region.min.x + (static_cast<float>(first) + static_cast<float>(i) + 0.5F) * texel.x;
      }
      shade_catcher(maps, x, y, found);
      for (std::size_t i = 0; i < kLanes; ++i, at += 4) {
        baked.pixels[at] = byte_of(found.red[i]);
        baked.pixels[at + 1] = byte_of(found.green[i]);
        baked.pixels[at + 2] = byte_of(found.blue[i]);
        baked.pixels[at + 3] = 255;
      }
    }
  }
  static_assert(kBakedSide % kLanes == 0);
  return baked;
}

MipTexture with_levels(ImageU8 image) {
  std::vector<ImageU8> levels;
  const int count = mip_level_count(image.width, image.height);
  for (int i = 0; i < count; ++i) {
    ImageU8 next = halved(image, false);
    levels.push_back(std::move(image));
    image = std::move(next);
  }
  MipTexture::Options options;
  options.wrap_s = options.wrap_t = GL_CLAMP_TO_EDGE;
  return {levels, options};
}

}  // namespace

void SoftwareCatchers::prepare(const LayerScene& scene, const Camera& camera,
                               const SoftwareCasters& casters) {
  shadows_.clear();
  for (auto& [hash, mask] : masks_) mask.used = false;
  for (const PlannedCatcher& planned :
       plan_catchers(scene, camera, *casters.points, casters.sun != nullptr)) {
    const PlanePatch& patch = scene.catchers[planned.patch];
    const CatcherPlan& plan = planned.plan;
    const Mask& mask = mask_of(patch, planned);
    Maps& kept = maps_[planned.patch];
    const std::uint64_t signature = map_signature(planned, scene, casters.signature);
    const bool anew = kept.signature != signature;
    kept.signature = signature;
    ShadowOnPlane shadow;
    shadow.frame = plan.frame;
    shadow.dark = shadow.over = plan.region;
    shadow.sun_share = plan.sun_share;
    shadow.maps.mask = image_over(mask.distance, mask.region);
    shadow.maps.edge_softness_m = patch.edge_softness_m;
    if (!plan.contact_region.empty()) {
      if (anew) kept.contact.make(plan, *casters.items, *casters.meshes, casters.detail_texels);
      shadow.maps.contact = image_over(kept.contact.hidden(), plan.contact_region);
      shadow.maps.contact_strength = plan.contact_strength;
    }
    if (plan.sun) {
      if (anew) kept.penumbra.make(*casters.sun, plan.frame.equation());
      set_sun(*casters.sun, kept.penumbra, scene.light, plan, shadow.maps);
    }
    if (casters.still) {
      if (anew || !kept.baked) {
        ImageU8 baked = bake(shadow.maps, plan.region);
        kept.dark = dark_part(baked, plan.region);
        kept.baked = with_levels(std::move(baked));
      }
      shadow.baked = &*kept.baked;
      shadow.dark = kept.dark;
    }
    if (!shadow.dark.empty()) shadows_.push_back(shadow);
  }
  std::erase_if(masks_, [](const auto& item) { return !item.second.used; });
}

const SoftwareCatchers::Mask& SoftwareCatchers::mask_of(const PlanePatch& patch,
                                                        const PlannedCatcher& planned) {
  ContentHash key;
  key.add(planned.hash);
  key.add(patch.edge_softness_m);
  const auto [place, is_new] = masks_.try_emplace(key.value());
  Mask& mask = place->second;
  mask.used = true;
  if (!is_new) return mask;
  mask.region = outer_region(patch, planned.plan.frame);
  // Shadows fade within the softness; a few cells more, and blending between cells never meets what
  // was not found.
  constexpr float kMoreCells = 3.0F;
  const glm::vec2 size = mask.region.size();
  const float reach_m =
      patch.edge_softness_m + kMoreCells * std::max(size.x, size.y) / static_cast<float>(kMaskSide);
  mask.distance = distance_to_edge(patch, planned.plan.frame, mask.region, kMaskSide, reach_m);
  return mask;
}

std::vector<glm::vec3> SoftwareCatchers::touched_points() const {
  std::vector<glm::vec3> points;
  for (const ShadowOnPlane& shadow : shadows_) {
    const auto corners = shadow.frame.corners(shadow.dark);
    points.insert(points.end(), corners.begin(), corners.end());
  }
  return points;
}

void SoftwareCatchers::clear() {
  shadows_.clear();
  maps_.clear();
  masks_.clear();
}

}  // namespace planecast::render
