#include "engine/output/match_move.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>

#include "engine/output/atomic_file.h"
#include "engine/output/ear_clip.h"
#include "engine/output/glb_builder.h"
#include "engine/output/palette.h"
#include "engine/user_error.h"

namespace planecast::engine {
namespace {

using slam::Pose;

/// glTF's axes of a camera (x right, y up, looking along -z) in the field's (x right, y down, z
/// forward); its own inverse.
Eigen::Matrix3d flip_yz() { return Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal(); }

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

/// Smallest turn of glTF's usual view of a camera world (flip_yz) that puts `up` on +y.
Eigen::Quaterniond gltf_from_world(const Eigen::Vector3d& up) {
  const Eigen::Vector3d flipped_up = flip_yz() * up.normalized();
  return Eigen::Quaterniond::FromTwoVectors(flipped_up, Eigen::Vector3d::UnitY()) *
         Eigen::Quaterniond(flip_yz());
}

/// The same scene with y negated, in world and camera: a negative fy becomes positive.
Reconstruction mirrored(Reconstruction scene) {
  const Eigen::Matrix3d mirror = Eigen::Vector3d(1.0, -1.0, 1.0).asDiagonal();
  scene.camera.fy = -scene.camera.fy;
  scene.up = mirror * scene.up;
  for (FrameRecord& frame : scene.frames) {
    if (!frame.world_from_cam) continue;
    frame.world_from_cam->linear() = mirror * frame.world_from_cam->linear() * mirror;
    frame.world_from_cam->translation() = mirror * frame.world_from_cam->translation();
  }
  for (PlaneRecord& plane : scene.planes) {
    for (Eigen::Vector3d* v : {&plane.normal, &plane.origin, &plane.x_axis}) *v = mirror * *v;
    for (Eigen::Vector3d& vertex : plane.polygon) vertex = mirror * vertex;
    for (auto& hole : plane.holes) {
      for (Eigen::Vector3d& vertex : hole) vertex = mirror * vertex;
    }
  }
  for (MapPoint& point : scene.points) point.position = mirror * point.position;
  return scene;
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

struct CameraTrack {
  std::vector<float> seconds;
  std::vector<std::array<float, 3>> translations;
  std::vector<std::array<float, 4>> rotations;
};

CameraTrack camera_track(const std::vector<FrameRecord>& frames) {
  CameraTrack track;
  Eigen::Quaterniond previous = Eigen::Quaterniond::Identity();
  for (const FrameRecord& frame : frames) {
    if (!frame.world_from_cam) continue;
    const auto seconds = static_cast<float>(frame.timestamp - frames.front().timestamp);
    if (!track.seconds.empty() && seconds <= track.seconds.back()) continue;
    Eigen::Quaterniond rotation(Eigen::Matrix3d(frame.world_from_cam->linear() * flip_yz()));
    rotation.normalize();
    // Importers interpolate component-wise: no jump to the opposite quaternion.
    if (rotation.dot(previous) < 0.0) rotation.coeffs() = -rotation.coeffs();
    previous = rotation;
    track.seconds.push_back(seconds);
    track.translations.push_back(to_float(frame.world_from_cam->translation()));
    track.rotations.push_back(to_float(rotation));
  }
  return track;
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

void add_root(const Reconstruction& scene, tinygltf::Model& model) {
  tinygltf::Node root;
  root.name = "world";
  const std::array<float, 4> rotation = to_float(gltf_from_world(scene.up));
  root.rotation.assign(rotation.begin(), rotation.end());
  model.nodes.push_back(std::move(root));
  tinygltf::Scene gltf_scene;
  gltf_scene.nodes.push_back(0);
  model.scenes.push_back(std::move(gltf_scene));
  model.defaultScene = 0;
}

}  // namespace

void write_match_move(const Reconstruction& reconstruction, const std::filesystem::path& path) {
  if (reconstruction.camera.fy < 0.0) {
    write_match_move(mirrored(reconstruction), path);
    return;
  }
  GlbBuilder builder;
  add_root(reconstruction, builder.model);
  add_camera_node(reconstruction, builder);
  for (const PlaneRecord& plane : reconstruction.planes) add_plane(plane, builder);
  add_points(reconstruction.points, builder);
  const std::string bytes = builder.bytes();
  if (bytes.empty()) throw UserError(fmt::format("{}: the scene cannot be encoded", path.string()));
  write_file(path, bytes);
}

}  // namespace planecast::engine
