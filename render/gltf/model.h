#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <string>
#include <vector>

#include "render/image.h"
#include "render/vertex.h"

namespace planecast::render {

/// Filters and wraps are OpenGL's numbers, as glTF has them.
struct ModelTexture {
  int image = -1;
  int min_filter = 9987;
  int mag_filter = 9729;
  int wrap_s = 10497;
  int wrap_t = 10497;
};

/// A use of a texture by a material.
struct TextureSlot {
  int texture = -1;  ///< -1: none
  int uv_set = 0;
  glm::mat3 transform = glm::mat3(1.0F);  ///< KHR_texture_transform, of (u, v, 1)
};

enum class AlphaMode { kOpaque, kMask, kBlend };

/// glTF 2.0 metallic-roughness, section 3.9.
struct Material {
  glm::vec4 base_color = glm::vec4(1.0F);  ///< linear
  float metallic = 1.0F;
  float roughness = 1.0F;
  glm::vec3 emissive{};
  float normal_scale = 1.0F;
  float occlusion_strength = 1.0F;
  float alpha_cutoff = 0.5F;
  AlphaMode alpha_mode = AlphaMode::kOpaque;
  bool double_sided = false;
  bool unlit = false;
  TextureSlot base_color_map;
  TextureSlot metallic_roughness_map;
  TextureSlot normal_map;
  TextureSlot occlusion_map;
  TextureSlot emissive_map;

  float ior = 1.5F;       ///< KHR_materials_ior; 0: no Fresnel falloff
  float specular = 1.0F;  ///< KHR_materials_specular
  glm::vec3 specular_color = glm::vec3(1.0F);
  float transmission = 0.0F;  ///< KHR_materials_transmission
  float clearcoat = 0.0F;     ///< KHR_materials_clearcoat
  float clearcoat_roughness = 0.0F;
  float clearcoat_normal_scale = 1.0F;
  glm::vec3 sheen_color{};  ///< KHR_materials_sheen
  float sheen_roughness = 0.0F;
  TextureSlot specular_map;
  TextureSlot specular_color_map;
  TextureSlot transmission_map;
  TextureSlot clearcoat_map;
  TextureSlot clearcoat_roughness_map;
  TextureSlot clearcoat_normal_map;
  TextureSlot sheen_color_map;
  TextureSlot sheen_roughness_map;

  /// Lets what is behind it through, so it is drawn after and over it.
  bool see_through() const { return alpha_mode == AlphaMode::kBlend || transmission > 0.0F; }
};

/// The same vertices joined to fewer triangles.
struct DetailLevel {
  std::vector<std::uint32_t> indices;
  float error = 0.0F;  ///< how far the surface has moved, in the shape's units
};

enum class Topology { kTriangles, kLines, kPoints };

/// Differences to the base shape; normals and tangents may be empty.
struct MorphTarget {
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;
  std::vector<glm::vec3> tangents;
};

/// Indexed triangles, lines or points with one material. Every stream has one entry a vertex or is
/// empty.
struct Primitive {
  std::vector<ShapeVertex> shape;
  std::vector<SurfaceVertex> surface;
  std::vector<std::uint32_t> indices;
  std::vector<DetailLevel> details;  ///< ever coarser; none for small, skinned or morphed meshes
  std::vector<std::array<std::uint16_t, 4>> joints;
  std::vector<glm::vec4> joint_weights;
  std::vector<MorphTarget> targets;
  int material = 0;
  Topology topology = Topology::kTriangles;
  bool unlit = false;         ///< whatever the material says: lines and points without normals
  Box box;                    ///< of the base shape
  bool flat_normals = false;  ///< three vertices a triangle, normals follow the shape
};

struct Mesh {
  std::vector<Primitive> primitives;
  std::vector<float> weights;
};

struct NodeTransform {
  glm::vec3 translation{};
  glm::quat rotation{1.0F, 0.0F, 0.0F, 0.0F};
  glm::vec3 scale = glm::vec3(1.0F);
};

struct Node {
  std::string name;
  int parent = -1;
  int mesh = -1;
  int skin = -1;
  NodeTransform rest;
  std::optional<glm::mat4> matrix;  ///< instead of `rest`; such a node is not animated
  std::vector<float> weights;
};

struct Skin {
  std::vector<int> joints;                      ///< nodes
  std::vector<glm::mat4> joint_from_skin_bind;  ///< inverse bind matrices
};

enum class ChannelPath { kTranslation, kRotation, kScale, kWeights };
enum class Interpolation { kStep, kLinear, kCubicSpline };

struct AnimationChannel {
  int node = -1;
  ChannelPath path = ChannelPath::kTranslation;
  Interpolation interpolation = Interpolation::kLinear;
  std::vector<float> times_s;  ///< increasing
  std::vector<float> values;   ///< `width` a key; three times that (in, value, out) for splines
  int width = 3;
};

struct Animation {
  std::string name;
  float duration_s = 0.0F;
  std::vector<AnimationChannel> channels;
};

/// Seen from its node: x right, y up, looking along -z.
struct ModelCamera {
  std::string name;
  int node = -1;
  bool perspective = true;
  float y_fov_rad = 0.8F;
  float half_height = 1.0F;  ///< of an orthographic camera
  float aspect = 0.0F;       ///< width over height; 0: the picture's
};

enum class LightKind { kDirectional, kPoint, kSpot };

/// KHR_lights_punctual; shines along its node's -z.
struct ModelLight {
  LightKind kind = LightKind::kPoint;
  int node = -1;
  glm::vec3 intensity = glm::vec3(1.0F);  ///< linear RGB; candela, or lux for a directional one
  float range = 0.0F;                     ///< 0: unlimited
  float inner_cone_rad = 0.0F;
  float outer_cone_rad = 0.785398F;
};

/// A glTF file, validated: every index in it points to something that exists.
class Model {
 public:
  std::vector<ImageU8> images;
  std::vector<ModelTexture> textures;
  std::vector<Material> materials;  ///< the last one is the default material
  std::vector<Mesh> meshes;
  std::vector<Node> nodes;
  std::vector<int> order;  ///< nodes of the default scene, parents before children
  std::vector<Skin> skins;
  std::vector<Animation> animations;
  std::vector<ModelCamera> cameras;  ///< one a node of the scene that has one
  std::vector<ModelLight> lights;    ///< likewise
  std::vector<std::string> scene_names;
  std::vector<std::string> variant_names;
};

}  // namespace planecast::render
