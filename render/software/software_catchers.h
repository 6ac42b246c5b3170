#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "render/passes/catcher_plan.h"
#include "render/passes/models.h"
#include "render/scene.h"
#include "render/software/contact_map.h"
#include "render/software/penumbra_map.h"
#include "render/software/plane_shadow.h"
#include "render/software/posed_meshes.h"
#include "render/software/sun_map.h"

namespace planecast::render {

/// What throws shadows in a frame.
struct SoftwareCasters {
  const std::vector<DrawItem>* items = nullptr;
  const PosedMeshes* meshes = nullptr;
  const std::vector<glm::vec3>* points = nullptr;  ///< corners of the items' boxes, world
  const SunMap* sun = nullptr;                     ///< null: no sun shadow
  std::uint64_t signature = 0;                     ///< changes when casters or the sun do
  bool still = false;  ///< no caster ever moves: shadows are baked once, not computed a frame
  float detail_texels = 0.0F;  ///< how far simplified meshes may be off in the maps
};

/// What CatcherPass does, by the processor.
class SoftwareCatchers {
 public:
  /// Finds which catchers receive anything and makes their maps.
  void prepare(const LayerScene& scene, const Camera& camera, const SoftwareCasters& casters);
  const std::vector<ShadowOnPlane>& shadows() const { return shadows_; }
  /// Corners of the rectangles that may get dark, world.
  std::vector<glm::vec3> touched_points() const;
  void clear();

 private:
  struct Mask {
    ImageF distance;
    PlaneRegion region;
    bool used = true;
  };
  /// Maps of one catcher; kept from frame to frame.
  struct Maps {
    std::uint64_t signature = 0;
    PenumbraMap penumbra;
    ContactMap contact;
    std::optional<MipTexture> baked;
    PlaneRegion dark;  ///< of what was baked
  };

  const Mask& mask_of(const PlanePatch& patch, const PlannedCatcher& planned);

  std::map<std::uint64_t, Mask> masks_;
  std::map<std::size_t, Maps> maps_;  ///< by the patch's place in the scene
  std::vector<ShadowOnPlane> shadows_;
};

}  // namespace planecast::render
