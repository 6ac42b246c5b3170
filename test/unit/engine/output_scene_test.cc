#include <gtest/gtest.h>
#include <tiny_gltf.h>

#include <cmath>
#include <cstring>
#include <numbers>
#include <sstream>

#include "engine/output/ear_clip.h"
#include "engine/output/match_move.h"
#include "engine/output/match_move_camera.h"
#include "engine/output/report_svg.h"
#include "test/unit/engine/output_test_files.h"

namespace planecast::engine {
namespace {

double area_of(const Triangulation& mesh) {
  double doubled = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Ring2d triangle = {mesh.vertices[static_cast<std::size_t>(a)],
                             mesh.vertices[static_cast<std::size_t>(b)],
                             mesh.vertices[static_cast<std::size_t>(c)]};
    EXPECT_GE(doubled_area(triangle), 0.0);
    doubled += doubled_area(triangle);
  }
  return doubled / 2.0;
}

Ring2d square(double x, double y, double side) {
  return {{x, y}, {x + side, y}, {x + side, y + side}, {x, y + side}};
}

TEST(EarClip, ConvexConcaveAndClockwise) {
  EXPECT_DOUBLE_EQ(area_of(triangulate_polygon(square(0, 0, 2), {})), 4.0);
  const Ring2d arrow = {
      {0, 0}, {4, 0}, {4, 4}, {2, 1}, {0, 4}};  // 16 less the triangle of 4 x 3 / 2
  EXPECT_DOUBLE_EQ(area_of(triangulate_polygon(arrow, {})), 10.0);
  EXPECT_DOUBLE_EQ(area_of(triangulate_polygon({arrow.rbegin(), arrow.rend()}, {})), 10.0);
}

TEST(EarClip, HolesAreLeftOpen) {
  const std::vector<Ring2d> holes = {square(1, 1, 2), square(6, 6, 1), square(5, 1, 3),
                                     square(1, 6, 3)};
  const Triangulation mesh = triangulate_polygon(square(0, 0, 10), holes);
  EXPECT_NEAR(area_of(mesh), 100.0 - 4.0 - 1.0 - 9.0 - 9.0, 1e-12);
  // 20 corners and 4 holes: n + 2h - 2 triangles, less those that are flat.
  EXPECT_LE(mesh.triangles.size(), 26U);
}

TEST(EarClip, HoleInTheBendOfAConcaveOutline) {
  const Ring2d outer = {{0, 0}, {10, 0}, {10, 10}, {8, 10}, {8, 2}, {2, 2}, {2, 10}, {0, 10}};
  const std::vector<Ring2d> holes = {{{4, 0.5}, {6, 0.5}, {6, 1.5}, {4, 1.5}},
                                     {{0.5, 5}, {1.5, 5}, {1, 8}}};
  EXPECT_NEAR(area_of(triangulate_polygon(outer, holes)), 52.0 - 2.0 - 1.5, 1e-12);
}

TEST(EarClip, DegenerateInputEnds) {
  EXPECT_TRUE(triangulate_polygon({}, {}).triangles.empty());
  EXPECT_TRUE(triangulate_polygon({{0, 0}, {1, 1}}, {}).triangles.empty());
  EXPECT_DOUBLE_EQ(area_of(triangulate_polygon({{0, 0}, {1, 1}, {2, 2}, {3, 3}}, {})), 0.0);
  const Ring2d bow_tie = {{0, 0}, {2, 2}, {2, 0}, {0, 2}};
  EXPECT_LE(area_of(triangulate_polygon(bow_tie, {})), 4.0);
}

Reconstruction sample_scene() {
  Reconstruction scene;
  scene.camera = test_camera();
  scene.metric = true;
  scene.mode = "mono";
  scene.up = Eigen::Vector3d(0.2, -1.0, 0.1).normalized();
  for (int i = 0; i < 30; ++i) {
    FrameRecord frame;
    frame.index = i;
    frame.timestamp = 1000.0 + i / 30.0;
    frame.state = "tracked";
    frame.inliers = 100 + i;
    if (i != 7) {
      frame.world_from_cam =
          make_pose({0.02 * i, -0.15 * i, 0.01 * i}, {0.1 * i, -0.02 * i, 0.05 * i});
    }
    scene.frames.push_back(frame);
  }
  PlaneRecord floor =
      make_rectangle(4, {0.0, 1.0, 3.0}, {0.0, -1.0, 0.0}, {1.0, 0.0, 0.0}, 2.0, 1.0);
  floor.plane_class = "floor";
  floor.holes = {
      make_rectangle(0, {0.0, 1.0, 3.0}, {0.0, -1.0, 0.0}, {1.0, 0.0, 0.0}, 0.5, 0.5).polygon};
  scene.planes = {floor};
  for (int i = 0; i < 50; ++i) {
    MapPoint point;
    point.position = Eigen::Vector3d(0.1 * i - 2.0, 1.0, 2.0 + std::sin(i));
    point.color_rgb = Eigen::Vector3f(255.0F, 0.0F, 0.0F);
    point.plane = i % 2 == 0 ? 4 : slam::kNone;
    scene.points.push_back(point);
  }
  return scene;
}

tinygltf::Model load(const std::filesystem::path& path) {
  tinygltf::Model model;
  tinygltf::TinyGLTF loader;
  std::string error;
  std::string warning;
  EXPECT_TRUE(loader.LoadBinaryFromFile(&model, &error, &warning, path.string())) << error;
  EXPECT_EQ(error + warning, "");
  return model;
}

int node_index(const tinygltf::Model& model, const std::string& name) {
  for (std::size_t i = 0; i < model.nodes.size(); ++i) {
    if (model.nodes[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

/// Element `index` of a float accessor.
std::vector<float> element(const tinygltf::Model& model, int accessor_index, std::size_t index) {
  const auto& accessor = model.accessors[static_cast<std::size_t>(accessor_index)];
  const auto& view = model.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
  const auto count = static_cast<std::size_t>(
      tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type)));
  std::vector<float> values(count);
  std::memcpy(values.data(),
              model.buffers[0].data.data() + view.byteOffset + index * count * sizeof(float),
              count * sizeof(float));
  return values;
}

Eigen::Quaterniond quaternion(const std::vector<double>& xyzw) {
  return {xyzw[3], xyzw[0], xyzw[1], xyzw[2]};
}

/// Root-from-camera pose of the animation at key `key`, and its time.
struct AnimatedCamera {
  float seconds = 0.0F;
  slam::Pose root_from_camera = slam::Pose::Identity();
};

AnimatedCamera animated_camera(const tinygltf::Model& model, std::size_t key) {
  AnimatedCamera result;
  for (const auto& channel : model.animations.at(0).channels) {
    EXPECT_EQ(channel.target_node, node_index(model, "camera"));
    const auto& sampler = model.animations[0].samplers[static_cast<std::size_t>(channel.sampler)];
    result.seconds = element(model, sampler.input, key)[0];
    const std::vector<float> value = element(model, sampler.output, key);
    if (channel.target_path == "translation") {
      result.root_from_camera.translation() = Eigen::Vector3d(value[0], value[1], value[2]);
    } else {
      const std::vector<double> q(value.begin(), value.end());
      result.root_from_camera.linear() = quaternion(q).toRotationMatrix();
    }
  }
  return result;
}

/// Pixel of a world point as a glTF viewer with the file's camera would draw it (principal point in
/// the middle).
Eigen::Vector2d gltf_pixel(const tinygltf::Model& model, const slam::Pose& root_from_camera,
                           const Eigen::Vector3d& root_point, int width, int height) {
  const auto& camera = model.cameras.at(0).perspective;
  const Eigen::Vector3d p = root_from_camera.inverse() * root_point;
  const double scale = 1.0 / std::tan(camera.yfov / 2.0);
  const double ndc_x = scale / camera.aspectRatio * p.x() / -p.z();
  const double ndc_y = scale * p.y() / -p.z();
  return {(ndc_x + 1.0) / 2.0 * width, (1.0 - ndc_y) / 2.0 * height};
}

TEST(MatchMove, CameraDrawsPointsWhereTheInputCameraSawThem) {
  const TestFolder folder;
  Reconstruction scene = sample_scene();
  scene.camera.cx = scene.camera.width / 2.0;  // glTF knows no other
  scene.camera.cy = scene.camera.height / 2.0;
  write_match_move(scene, folder / "scene.glb");
  const tinygltf::Model model = load(folder / "scene.glb");
  std::size_t key = 0;
  for (const FrameRecord& frame : scene.frames) {
    if (!frame.world_from_cam) continue;
    const AnimatedCamera camera = animated_camera(model, key++);
    EXPECT_NEAR(camera.seconds, frame.timestamp - 1000.0, 1e-6);
    const Eigen::Vector3d point = *frame.world_from_cam * Eigen::Vector3d(0.3, -0.2, 2.0);
    const Eigen::Vector2d expected = scene.camera.project({0.3, -0.2, 2.0});
    // Poses are floats: 24 bits of a metre at 525 px focal length, 2 m away.
    EXPECT_LT((gltf_pixel(model, camera.root_from_camera, point, 640, 480) - expected).norm(),
              1e-3);
  }
  EXPECT_EQ(key, 29U);
}

TEST(MatchMove, FieldOfViewAndPoseAreTheInputs) {
  const TestFolder folder;
  const Reconstruction scene = sample_scene();
  write_match_move(scene, folder / "scene.glb");
  const tinygltf::Model model = load(folder / "scene.glb");
  const auto& perspective = model.cameras.at(0).perspective;
  EXPECT_NEAR(perspective.yfov, 2.0 * std::atan(240.0 / 530.0), 1e-12);
  EXPECT_NEAR(perspective.aspectRatio, (640.0 / 525.0) / (480.0 / 530.0), 1e-12);
  EXPECT_NEAR(model.cameras[0].extras.Get("cx").GetNumberAsDouble(), 318.0, 1e-12);
  const slam::Pose pose = animated_camera(model, 10).root_from_camera;  // frame 7 has no pose
  const slam::Pose& input = *scene.frames[11].world_from_cam;
  EXPECT_LT((pose.translation() - input.translation()).norm(), 1e-6);
  const Eigen::Vector3d view = pose.linear() * -Eigen::Vector3d::UnitZ();
  EXPECT_LT((view - input.linear() * Eigen::Vector3d::UnitZ()).norm(), 1e-6);
  const Eigen::Vector3d image_up = pose.linear() * Eigen::Vector3d::UnitY();
  EXPECT_LT((image_up + input.linear() * Eigen::Vector3d::UnitY()).norm(), 1e-6);
}

TEST(MatchMove, UpIsYAndQuaternionsDoNotJump) {
  const TestFolder folder;
  const Reconstruction scene = sample_scene();
  write_match_move(scene, folder / "scene.glb");
  const tinygltf::Model model = load(folder / "scene.glb");
  const tinygltf::Node& root =
      model.nodes.at(static_cast<std::size_t>(model.scenes[0].nodes.at(0)));
  EXPECT_EQ(root.name, "world");
  EXPECT_LT((quaternion(root.rotation) * scene.up - Eigen::Vector3d::UnitY()).norm(), 1e-6);
  for (std::size_t key = 1; key < 29; ++key) {
    const int output = model.animations[0].samplers[1].output;
    double dot = 0.0;
    for (std::size_t c = 0; c < 4; ++c) {
      dot += element(model, output, key - 1)[c] * element(model, output, key)[c];
    }
    EXPECT_GT(dot, 0.9);
  }
}

TEST(MatchMove, PlanesFaceTheirNormalAndKeepTheirHoles) {
  const TestFolder folder;
  const Reconstruction scene = sample_scene();
  write_match_move(scene, folder / "scene.glb");
  const tinygltf::Model model = load(folder / "scene.glb");
  const int node = node_index(model, "plane 4 floor");
  ASSERT_GE(node, 0);
  const auto& mesh =
      model.meshes[static_cast<std::size_t>(model.nodes[static_cast<std::size_t>(node)].mesh)];
  const auto& primitive = mesh.primitives.at(0);
  const auto& indices = model.accessors[static_cast<std::size_t>(primitive.indices)];
  const auto& view = model.bufferViews[static_cast<std::size_t>(indices.bufferView)];
  std::vector<std::uint32_t> index(indices.count);
  std::memcpy(index.data(), model.buffers[0].data.data() + view.byteOffset, 4 * indices.count);
  Eigen::Vector3d area = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i + 2 < index.size(); i += 3) {
    std::array<Eigen::Vector3d, 3> corner;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::vector<float> p =
          element(model, primitive.attributes.at("POSITION"), index[i + k]);
      corner[k] = Eigen::Vector3d(p[0], p[1], p[2]);
    }
    area += (corner[1] - corner[0]).cross(corner[2] - corner[0]) / 2.0;
  }
  EXPECT_LT((area - 1.75 * scene.planes[0].normal).norm(), 1e-6);
  EXPECT_GE(node_index(model, "points"), 0);
}

TEST(MatchMove, NegativeFyIsWrittenAsTheMirroredWorld) {
  const TestFolder folder;
  Reconstruction scene = sample_scene();
  scene.camera.fy = -530.0;
  scene.camera.cx = 320.0;
  scene.camera.cy = 240.0;
  write_match_move(scene, folder / "scene.glb");
  const tinygltf::Model model = load(folder / "scene.glb");
  const AnimatedCamera camera = animated_camera(model, 5);
  const Eigen::Vector3d in_camera(0.3, -0.2, 2.0);
  Eigen::Vector3d point = *scene.frames[5].world_from_cam * in_camera;
  point.y() = -point.y();
  EXPECT_LT((gltf_pixel(model, camera.root_from_camera, point, 640, 480) -
             scene.camera.project(in_camera))
                .norm(),
            1e-3);
}

TEST(MatchMove, EmptyReconstructionIsAValidFile) {
  const TestFolder folder;
  Reconstruction scene;
  scene.camera = test_camera();
  write_match_move(scene, folder / "scene.glb");
  const tinygltf::Model model = load(folder / "scene.glb");
  EXPECT_TRUE(model.animations.empty());
  EXPECT_GE(node_index(model, "camera"), 0);
}

TEST(MatchMove, SameInputSameBytes) {
  const TestFolder folder;
  write_match_move(sample_scene(), folder / "a.glb");
  write_match_move(sample_scene(), folder / "b.glb");
  EXPECT_TRUE(read_file(folder / "a.glb") == read_file(folder / "b.glb"));
}

TEST(MatchMove, ObjectsHaveTheirModelsOwnSpace) {
  const TestFolder folder;
  ObjectRecord object;
  object.name = "robot";
  object.file = "robot.glb";
  object.box = Eigen::AlignedBox3d(Eigen::Vector3d(-1, 0, -2), Eigen::Vector3d(1, 3, 2));
  object.world_from_model = Eigen::Translation3d(0.3, 1.0, 2.0) *
                            Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 0).normalized()) *
                            Eigen::Scaling(0.1);
  write_match_move(sample_scene(), folder / "scene.glb", {object});
  const tinygltf::Model model = load(folder / "scene.glb");
  const int index = node_index(model, "object robot");
  ASSERT_GE(index, 0);
  const tinygltf::Node& node = model.nodes[static_cast<std::size_t>(index)];
  EXPECT_EQ(node.extras.Get("file").Get<std::string>(), "robot.glb");
  const auto& primitive = model.meshes[static_cast<std::size_t>(node.mesh)].primitives.at(0);
  const Eigen::Affine3d world_from_node =
      Eigen::Translation3d(node.translation[0], node.translation[1], node.translation[2]) *
      quaternion(node.rotation) * Eigen::Scaling(node.scale[0]);
  EXPECT_LT((world_from_node.matrix() - object.world_from_model.matrix()).norm(), 1e-6);
  const std::vector<float> last = element(model, primitive.attributes.at("POSITION"), 7);
  EXPECT_EQ(Eigen::Vector3d(last[0], last[1], last[2]), object.box.max());
}

TEST(MatchMove, ChanHasPlaceAnglesAndFieldOfView) {
  const TestFolder folder;
  const Reconstruction scene = sample_scene();
  write_chan(scene, folder / "camera.chan");
  std::istringstream in(read_file(folder / "camera.chan"));
  const Eigen::Matrix3d turn = gltf_from_world(scene.up).toRotationMatrix();
  int lines = 0;
  int frame = 0;
  Eigen::Vector3d t;
  Eigen::Vector3d angles;
  for (double fov = 0.0;
       in >> frame >> t.x() >> t.y() >> t.z() >> angles.x() >> angles.y() >> angles.z() >> fov;
       ++lines) {
    const slam::Pose& pose = *scene.frames[static_cast<std::size_t>(frame - 1)].world_from_cam;
    EXPECT_LT((t - turn * pose.translation()).norm(), 1e-6);
    angles *= std::numbers::pi / 180.0;
    const Eigen::Matrix3d rotation = (Eigen::AngleAxisd(angles.y(), Eigen::Vector3d::UnitY()) *
                                      Eigen::AngleAxisd(angles.x(), Eigen::Vector3d::UnitX()) *
                                      Eigen::AngleAxisd(angles.z(), Eigen::Vector3d::UnitZ()))
                                         .toRotationMatrix();
    EXPECT_LT((rotation - turn * pose.linear() * flip_yz()).norm(), 1e-6);
    EXPECT_NEAR(fov, 2.0 * std::atan(240.0 / 530.0) * 180.0 / std::numbers::pi, 1e-6);
  }
  EXPECT_EQ(lines, 29);
}

TEST(Report, TopViewPutsTheViewingDirectionUpAndRightRight) {
  Reconstruction scene;
  scene.camera = test_camera();
  scene.frames.resize(2);
  scene.frames[0].world_from_cam = slam::Pose::Identity();
  scene.frames[1].world_from_cam = make_pose(Eigen::Vector3d::Zero(), {1.0, 0.0, 2.0});
  const std::string svg = top_view_svg(scene);
  const std::size_t begin = svg.find("<path d=\"M", svg.find("<svg")) + 10;
  double x0 = 0.0;
  double y0 = 0.0;
  double x1 = 0.0;
  double y1 = 0.0;
  ASSERT_EQ(std::sscanf(svg.c_str() + begin, "%lf,%lfL%lf,%lf", &x0, &y0, &x1, &y1), 4) << svg;
  EXPECT_GT(x1, x0);
  EXPECT_LT(y1, y0);
}

}  // namespace
}  // namespace planecast::engine
