#include "engine/output/match_move.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>

#include "engine/output/atomic_file.h"
#include "engine/output/ear_clip.h"
#include "engine/output/glb_builder.h"
#include "engine/output/match_move_camera.h"
#include "engine/output/palette.h"
#include "engine/user_error.h"

namespace planecast::engine {
namespace {

using slam::Pose;

std::array<float, 3> to_float(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

std::array<float, 4> to_float(const Eigen::Quaterniond& q) {
  return {static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z()),
          static_cast<float>(q.w())};
}

double linear_of_srgb(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

int add_camera(const slam::Camera& camera, tinygltf::Model& model) {
  tinygltf::Camera gltf;
  gltf.name = "camera";
  gltf.type = "perspective";
  gltf.perspective.aspectRatio = (camera.width / camera.fx) / (camera.height / camera.fy);
  gltf.perspective.yfov = 2.0 * std::atan(camera.height / (2.0 * camera.fy));
  gltf.perspective.znear = 0.01;
  gltf.perspective.zfar = 1000.0;
  tinygltf::Value::Object extras;
  extras["width"] = tinygltf::Value(camera.width);
  extras["height"] = tinygltf::Value(camera.height);
  extras["fx"] = tinygltf::Value(camera.fx);
  extras["fy"] = tinygltf::Value(camera.fy);
  extras["cx"] = tinygltf::Value(camera.cx);
  extras["cy"] = tinygltf::Value(camera.cy);
  gltf.extras = tinygltf::Value(extras);
  model.cameras.push_back(std::move(gltf));
  return static_cast<int>(model.cameras.size()) - 1;
}

void add_channel(int node, const char* path, int input, int output,
                 tinygltf::Animation& animation) {
  tinygltf::AnimationSampler sampler;
  sampler.input = input;
  sampler.output = output;
  sampler.interpolation = "LINEAR";
  tinygltf::AnimationChannel channel;
  channel.sampler = static_cast<int>(animation.samplers.size());
  channel.target_node = node;
  channel.target_path = path;
  animation.samplers.push_back(std::move(sampler));
  animation.channels.push_back(std::move(channel));
}

/// Adds `node` as a child of the root, which is node 0.
int add_child(tinygltf::Node node, tinygltf::Model& model) {
  model.nodes.push_back(std::move(node));
  const int index = static_cast<int>(model.nodes.size()) - 1;
  model.nodes[0].children.push_back(index);
  return index;
}

void add_camera_node(const Reconstruction& scene, GlbBuilder& builder) {
  const CameraTrack track = camera_track(scene.frames);
  tinygltf::Node node;
  node.name = "camera";
  node.camera = add_camera(scene.camera, builder.model);
  if (!track.seconds.empty()) {
    node.translation.assign(track.translations[0].begin(), track.translations[0].end());
    node.rotation.assign(track.rotations[0].begin(), track.rotations[0].end());
  }
  const int index = add_child(std::move(node), builder.model);
  if (track.seconds.empty()) return;
  tinygltf::Animation animation;
  animation.name = "camera";
  const int input = builder.add_times(track.seconds);
  add_channel(index, "translation", input, builder.add_vectors(track.translations), animation);
  add_channel(index, "rotation", input, builder.add_quaternions(track.rotations), animation);
  builder.model.animations.push_back(std::move(animation));
}

int add_plane_material(const PlaneRecord& plane, tinygltf::Model& model) {
  tinygltf::Material material;
  material.name = fmt::format("plane {}", plane.id);
  std::vector<double> color;
  for (const std::uint8_t channel : plane_color(plane.id)) {
    color.push_back(linear_of_srgb(channel / 255.0));
  }
  color.push_back(0.6);
  material.pbrMetallicRoughness.baseColorFactor = color;
  material.pbrMetallicRoughness.metallicFactor = 0.0;
  material.pbrMetallicRoughness.roughnessFactor = 1.0;
  material.alphaMode = "BLEND";
  material.doubleSided = true;
  model.materials.push_back(std::move(material));
  return static_cast<int>(model.materials.size()) - 1;
}

Ring2d in_plane(const std::vector<Eigen::Vector3d>& ring, const Pose& plane_from_world) {
  Ring2d flat;
  for (const Eigen::Vector3d& vertex : ring) flat.push_back((plane_from_world * vertex).head<2>());
  return flat;
}

/// A translucent box in place of a model, in the model's own space, so that the model itself
/// fits when it is put under the node.
int add_box_material(tinygltf::Model& model) {
  tinygltf::Material material;
  material.name = "object";
  material.pbrMetallicRoughness.baseColorFactor = {0.8, 0.35, 0.05, 0.5};
  material.pbrMetallicRoughness.metallicFactor = 0.0;
  material.alphaMode = "BLEND";
  material.doubleSided = true;
  model.materials.push_back(std::move(material));
  return static_cast<int>(model.materials.size()) - 1;
}

int add_mesh(const std::string& name, tinygltf::Primitive primitive, tinygltf::Model& model) {
  tinygltf::Mesh mesh;
  mesh.name = name;
  mesh.primitives.push_back(std::move(primitive));
  model.meshes.push_back(std::move(mesh));
  return static_cast<int>(model.meshes.size()) - 1;
}

void add_plane(const PlaneRecord& plane, GlbBuilder& builder) {
  const Pose world_from_plane = plane.world_from_plane();
  const Pose plane_from_world = world_from_plane.inverse();
  std::vector<Ring2d> holes;
  for (const auto& hole : plane.holes) holes.push_back(in_plane(hole, plane_from_world));
  const Triangulation mesh = triangulate_polygon(in_plane(plane.polygon, plane_from_world), holes);
  if (mesh.triangles.empty()) return;

  std::vector<std::array<float, 3>> positions;
  for (const Eigen::Vector2d& vertex : mesh.vertices) {
    positions.push_back(to_float(world_from_plane * Eigen::Vector3d(vertex.x(), vertex.y(), 0.0)));
  }
  std::vector<std::uint32_t> indices;
  for (const std::array<int, 3>& triangle : mesh.triangles) {
    for (const int vertex : triangle) indices.push_back(static_cast<std::uint32_t>(vertex));
  }
  tinygltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  primitive.attributes["POSITION"] = builder.add_positions(positions);
  primitive.indices = builder.add_indices(indices);
  primitive.material = add_plane_material(plane, builder.model);
  tinygltf::Node node;
  node.name = fmt::format("plane {} {}", plane.id, plane.plane_class);
  node.mesh = add_mesh(node.name, std::move(primitive), builder.model);
  add_child(std::move(node), builder.model);
}

void add_points(const std::vector<MapPoint>& points, GlbBuilder& builder) {
  if (points.empty()) return;
  std::vector<std::array<float, 3>> positions;
  std::vector<std::array<std::uint16_t, 4>> colors;
  for (const MapPoint& point : points) {
    positions.push_back(to_float(point.position));
    std::array<std::uint16_t, 4> color = {0, 0, 0, 65535};
    for (int c = 0; c < 3; ++c) {
      const double encoded = std::clamp(point.color_rgb[c] / 255.0, 0.0, 1.0);
      color[static_cast<std::size_t>(c)] =
          static_cast<std::uint16_t>(std::lround(65535.0 * linear_of_srgb(encoded)));
    }
    colors.push_back(color);
  }
  tinygltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_POINTS;
  primitive.attributes["POSITION"] = builder.add_positions(positions);
  primitive.attributes["COLOR_0"] = builder.add_colors(colors);
  tinygltf::Node node;
  node.name = "points";
  node.mesh = add_mesh(node.name, std::move(primitive), builder.model);
  add_child(std::move(node), builder.model);
}

tinygltf::Primitive box_mesh(const Eigen::AlignedBox3d& box, int material, GlbBuilder& builder) {
  std::vector<std::array<float, 3>> corners;
  for (int i = 0; i < 8; ++i) {
    corners.push_back(to_float(box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i))));
  }
  // Corner i has the larger x, y, z where bits 0, 1, 2 are set.
  const std::vector<std::uint32_t> sides = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                            2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
  tinygltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  primitive.attributes["POSITION"] = builder.add_positions(corners);
  primitive.indices = builder.add_indices(sides);
  primitive.material = material;
  return primitive;
}

void add_objects(const std::vector<ObjectRecord>& objects, GlbBuilder& builder) {
  if (objects.empty()) return;
  const int material = add_box_material(builder.model);
  for (const ObjectRecord& object : objects) {
    const double scale = std::cbrt(object.world_from_model.linear().determinant());
    const Eigen::Quaterniond turn(Eigen::Matrix3d(object.world_from_model.linear() / scale));
    tinygltf::Node node;
    node.name = "object " + object.name;
    const std::array<float, 3> place = to_float(object.world_from_model.translation());
    const std::array<float, 4> rotation = to_float(turn.normalized());
    node.translation.assign(place.begin(), place.end());
    node.rotation.assign(rotation.begin(), rotation.end());
    node.scale.assign(3, scale);
    tinygltf::Value::Object extras;
    extras["file"] = tinygltf::Value(object.file);
    node.extras = tinygltf::Value(extras);
    node.mesh = add_mesh(node.name, box_mesh(object.box, material, builder), builder.model);
    add_child(std::move(node), builder.model);
  }
}

/// The scene in the mirrored world; the models' boxes are mirrored with it.
std::vector<ObjectRecord> mirrored(std::vector<ObjectRecord> objects) {
  const Eigen::Affine3d mirror(Eigen::Scaling(1.0, -1.0, 1.0));
  for (ObjectRecord& object : objects) {
    object.world_from_model = mirror * object.world_from_model * mirror;
    const Eigen::AlignedBox3d box = object.box;
    object.box = Eigen::AlignedBox3d(Eigen::Vector3d(box.min().x(), -box.max().y(), box.min().z()),
                                     Eigen::Vector3d(box.max().x(), -box.min().y(), box.max().z()));
  }
  return objects;
}

void add_root(const Reconstruction& scene, tinygltf::Model& model) {
  tinygltf::Node root;
  root.name = "world";
  const std::array<float, 4> rotation = to_float(gltf_from_world(scene.up));
  root.rotation.assign(rotation.begin(), rotation.end());
  tinygltf::Value::Object extras;
  extras["fps"] = tinygltf::Value(frame_rate(scene.frames));
  extras["frames"] = tinygltf::Value(static_cast<int>(scene.frames.size()));
  extras["metres"] = tinygltf::Value(scene.metric);
  root.extras = tinygltf::Value(extras);
  model.nodes.push_back(std::move(root));
  tinygltf::Scene gltf_scene;
  gltf_scene.nodes.push_back(0);
  model.scenes.push_back(std::move(gltf_scene));
  model.defaultScene = 0;
}

}  // namespace

void write_match_move(const Reconstruction& reconstruction, const std::filesystem::path& path,
                      const std::vector<ObjectRecord>& objects) {
  if (reconstruction.camera.fy < 0.0) {
    write_match_move(mirrored(reconstruction), path, mirrored(objects));
    return;
  }
  GlbBuilder builder;
  add_root(reconstruction, builder.model);
  add_camera_node(reconstruction, builder);
  for (const PlaneRecord& plane : reconstruction.planes) add_plane(plane, builder);
  add_points(reconstruction.points, builder);
  add_objects(objects, builder);
  const std::string bytes = builder.bytes();
  if (bytes.empty()) throw UserError(fmt::format("{}: the scene cannot be encoded", path.string()));
  write_file(path, bytes);
}

}  // namespace planecast::engine
