#pragma once

#include <array>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

#include "render/image.h"

namespace planecast::render {

/// Pinhole camera in the field's convention: x right, y down, z forward; pixel centres are
/// integers. Undistorted. fy may be negative (the picture is then upside down, as ICL-NUIM's model
/// is).
struct Camera {
  int width = 640;
  int height = 480;
  float fx = 525.0F, fy = 525.0F, cx = 319.5F, cy = 239.5F;
  float near_plane = 0.01F;
  float far_plane = 100.0F;
  glm::mat4 camera_from_world = glm::mat4(1.0F);
};

struct Sun {
  glm::vec3 direction_to_light = {0.3F, -0.9F, 0.2F};  ///< unit, world
  glm::vec3 radiance = glm::vec3(2.0F);  ///< linear RGB irradiance on a facing surface / pi
  bool casts_shadow = true;
  float softness = 1.0F;  ///< radius of the shadow's filter in shadow-map texels, at least
  /// Half the angle the light is wide: shadows on catchers blur with the distance of what casts
  /// them. The sun's is 0.0046; lamps and windows are wider.
  float angular_radius_rad = 0.05F;
};

class Environment;

/// Light of a scene: diffuse surroundings as spherical harmonics of order 2 (9 coefficients, linear
/// RGB radiance, real SH basis without the Condon-Shortley sign: 1, y, z, x, xy, yz, 3z^2-1, xz,
/// x^2-y^2 of the world direction) and one main direction.
struct Light {
  std::array<glm::vec3, 9>
      ambient_sh{};  ///< [0] alone: uniform surroundings of radiance c / 3.5449
  Sun sun;
  /// Where reflections are taken from instead of the harmonics; see render/environment.h. The
  /// harmonics are still what matt surfaces are lit by.
  std::shared_ptr<const Environment> environment;
  glm::mat3 environment_from_world = glm::mat3(1.0F);
  float environment_gain = 1.0F;
  static Light uniform(glm::vec3 ambient_radiance, Sun sun);
};

/// A loaded glTF file; see render/gltf/import.h.
class Model;

struct Instance {
  std::shared_ptr<const Model> model;
  glm::mat4 world_from_model = glm::mat4(1.0F);  ///< glTF model space: y up, metres
  int animation = -1;                            ///< index, -1 = rest pose
  float animation_time_s = 0.0F;                 ///< looped by the renderer
};

/// A flat polygon of the world that receives shadows (catcher) or hides what is behind it
/// (occluder): outer ring counter-clockwise seen from the normal's side, not closed, maybe concave,
/// holes allowed.
struct PlanePatch {
  glm::vec3 normal{};
  std::vector<glm::vec3> outer;
  std::vector<std::vector<glm::vec3>> holes;
  float edge_softness_m = 0.05F;  ///< shadows fade out over this width at the polygon's edge
};

enum class ToneMap {
  kNone,     ///< light beyond 1 is cut off: what is to match a video
  kNeutral,  ///< Khronos PBR Neutral: colours up to about 0.8 as they are, brighter ones compressed
};

/// What one layer is drawn from.
struct LayerScene {
  std::vector<Instance> instances;
  std::vector<PlanePatch> catchers;
  std::vector<PlanePatch> occluders;
  const ImageF* occluder_depth = nullptr;  ///< optional, metres along z, 0 = unknown; camera's size
  Light light;
  float shadow_strength = 1.0F;  ///< 0 none .. 1 physically by the light
  float exposure = 1.0F;         ///< factor on the objects' light
  ToneMap tone_map = ToneMap::kNone;
  /// Whether light, catchers and the instances' places stay as they are in the frames to come:
  /// shadows of what no animation moves are then made once. Changes what is fast, and the picture
  /// by rounding alone.
  bool still = true;
  bool with_depth = true;  ///< Layer::depth is wanted; a second pass over the meshes
};

/// RGBA8, sRGB-encoded, premultiplied: out = layer.rgb + (1 - layer.a) * frame. A shadow is black
/// with alpha. Depth in metres along z of the objects alone, 0 where there is none; empty when the
/// scene does not want it.
struct Layer {
  ImageU8 rgba;
  ImageF depth;
  struct Rect {
    int x = 0, y = 0, width = 0, height = 0;
  } bounds;                   ///< outside it all is transparent
  bool by_processor = false;  ///< drawn without OpenGL; see RendererOptions::only_opengl
};

/// A surface of an opaque scene such as the synthetic generator's: own triangles, one material. Lit
/// by its normals from either side; casts a shadow only where its normal faces the sun, so that the
/// walls of a closed room let the sun in.
struct SurfaceMesh {
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;
  std::vector<glm::vec2> uvs;
  std::vector<std::uint32_t> indices;
  std::shared_ptr<const ImageU8>
      base_color;  ///< 3 or 4 channels, sRGB; repeated; mip-mapped, anisotropic
  glm::vec3 color_factor = glm::vec3(1.0F);  ///< linear
  float roughness = 0.9F;
  int label = 0;  ///< written to OpaqueImages::labels
};

struct OpaqueScene {
  std::vector<SurfaceMesh> surfaces;
  std::vector<Instance> instances;  ///< glTF models among them, label 0
  Light light;
  float exposure = 1.0F;
};

struct OpaqueImages {
  ImageU8 rgb;                  ///< sRGB
  ImageF depth;                 ///< metres along z, 0 where nothing is; at pixel centres, no MSAA
  Image<std::uint16_t> labels;  ///< at pixel centres, no MSAA
};

}  // namespace planecast::render
