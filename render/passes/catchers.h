#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "render/gl/objects.h"
#include "render/gl/program.h"
#include "render/passes/catcher_plan.h"
#include "render/passes/model_passes.h"
#include "render/passes/shadow_map.h"
#include "render/scene.h"

namespace planecast::render {

/// What all catchers of a frame share.
struct CatcherInput {
  const LayerScene* scene = nullptr;
  const Camera* camera = nullptr;
  const std::vector<DrawItem>* items = nullptr;
  const std::vector<glm::vec3>* caster_points = nullptr;  ///< corners of the items' boxes, world
  const ShadowMap* shadow = nullptr;                      ///< null: no sun shadow
  std::uint64_t casters = 0;                              ///< changes when casters or the sun do
  bool still = false;  ///< no caster ever moves: shadows are baked once, not computed a frame
  float detail_texels = 0.0F;  ///< how far simplified meshes may be off in the maps
};

/// Shadows on the planes of the recorded world. Two parts, each made once for casters and light
/// that stand still: the sun's shadow with a penumbra growing with the distance of what casts it,
/// and the contact shadow, the surroundings' light that the objects keep from the plane.
class CatcherPass {
 public:
  explicit CatcherPass(const Gl& gl, const ModelPasses& models);

  /// Finds which catchers receive anything and makes their maps. Call before binding the target.
  void prepare(ShaderLibrary& shaders, const CatcherInput& input);
  /// Corners of the rectangles that may get dark, world.
  std::vector<glm::vec3> touched_points(const CatcherInput& input) const;
  /// Blends black over the bound target; reads its depth, leaves it.
  void draw(ShaderLibrary& shaders, const CatcherInput& input, GLuint occluder_depth,
            float occluder_tolerance) const;
  void clear();

 private:
  struct Mask {
    TextureHandle texture;
    PlaneRegion region;
    bool used = true;
  };
  /// Maps of one catcher; kept from frame to frame.
  struct Maps {
    std::uint64_t signature = 0;
    TextureHandle penumbra;
    TextureHandle contact;
    int contact_side = 0;
    TextureHandle baked;  ///< what catcher.frag finds over the plan's region
    PlaneRegion dark;     ///< the part of it that is not quite bright
  };
  struct Prepared {
    CatcherPlan plan;
    const Mask* mask = nullptr;
    Maps* maps = nullptr;
    float edge_softness_m = 0.0F;

    PlaneRegion drawn(bool still) const { return still ? maps->dark : plan.region; }
  };

  const Mask& mask_of(const PlanePatch& patch, const PlaneFrame& frame, std::uint64_t hash);
  void make_penumbra(ShaderLibrary& shaders, const CatcherInput& input, const PlaneFrame& frame,
                     Maps& maps);
  void make_contact(ShaderLibrary& shaders, const CatcherInput& input, const CatcherPlan& plan,
                    Maps& maps);
  void bake(ShaderLibrary& shaders, const CatcherInput& input, const Prepared& prepared,
            Maps& maps);
  void set_shadow_inputs(const Program& program, const CatcherInput& input,
                         const Prepared& prepared) const;
  void set_plane(const Program& program, const PlaneFrame& frame, const PlaneRegion& region) const;
  void begin_map(GLuint texture, int size) const;

  const Gl* gl_;
  const ModelPasses* models_;
  VertexArrayHandle no_vertices_;
  FramebufferHandle framebuffer_;
  TextureHandle heights_;
  TextureHandle unblurred_contact_;
  int contact_side_ = 0;
  std::map<std::uint64_t, Mask> masks_;
  std::map<std::size_t, Maps> maps_;  ///< by the patch's place in the scene
  std::vector<Prepared> prepared_;
};

}  // namespace planecast::render
