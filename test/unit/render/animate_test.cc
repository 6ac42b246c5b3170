#include "render/gltf/animate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "render/gltf/import.h"
#include "render_test_tools.h"

namespace planecast::render {
namespace {

/// A parent at (1, 0, 0) with a child at (0, 2, 0); no meshes.
Model two_nodes() {
  Model model;
  model.nodes.resize(2);
  model.nodes[0].rest.translation = {1, 0, 0};
  model.nodes[1].rest.translation = {0, 2, 0};
  model.nodes[1].parent = 0;
  model.order = {0, 1};
  return model;
}

void add_channel(Model& model, AnimationChannel channel) {
  if (model.animations.empty()) model.animations.emplace_back();
  Animation& animation = model.animations[0];
  animation.duration_s = std::max(animation.duration_s, channel.times_s.back());
  animation.channels.push_back(std::move(channel));
}

glm::vec3 origin_of(const Model& model, int node, float time_s, int animation = 0) {
  return glm::vec3(
      evaluate_pose(model, animation, time_s).model_from_node[static_cast<std::size_t>(node)][3]);
}

void expect_near(const glm::vec3& a, const glm::vec3& b) {
  EXPECT_LT(glm::length(a - b), 1e-5F) << a.x << " " << a.y << " " << a.z;
}

TEST(Animate, RestPoseChainsNodes) {
  Model model = two_nodes();
  expect_near(origin_of(model, 1, 0.0F, -1), {1, 2, 0});
  expect_near(origin_of(model, 1, 0.0F, 7), {1, 2, 0});
  model.nodes[0].matrix = glm::translate(glm::mat4(1.0F), glm::vec3(0, 0, 9));
  expect_near(origin_of(model, 1, 0.0F, -1), {0, 2, 9});
}

TEST(Animate, LinearTranslationMovesTheSubtreeAndLoops) {
  Model model = two_nodes();
  add_channel(
      model,
      {0, ChannelPath::kTranslation, Interpolation::kLinear, {0.5F, 1.5F}, {0, 0, 0, 4, 0, 0}, 3});
  expect_near(origin_of(model, 1, 0.0F), {0, 2, 0});  // before the first key
  expect_near(origin_of(model, 1, 0.75F), {1, 2, 0});
  expect_near(origin_of(model, 1, 1.5F), {4, 2, 0});
  expect_near(origin_of(model, 1, 1.5F + 0.75F), {1, 2, 0});
  expect_near(origin_of(model, 1, -0.75F), {1, 2, 0});
  EXPECT_FLOAT_EQ(animation_duration_s(model, 0), 1.5F);
}

TEST(Animate, StepHoldsItsValue) {
  Model model = two_nodes();
  add_channel(model, {0,
                      ChannelPath::kTranslation,
                      Interpolation::kStep,
                      {0, 1, 2},
                      {0, 0, 0, 4, 0, 0, 8, 0, 0},
                      3});
  expect_near(origin_of(model, 0, 0.99F), {0, 0, 0});
  expect_near(origin_of(model, 0, 1.0F), {4, 0, 0});
  expect_near(origin_of(model, 0, 1.99F), {4, 0, 0});
}

TEST(Animate, RotationTakesTheShorterWayAtEvenSpeed) {
  Model model = two_nodes();
  const float half = std::sqrt(0.5F);
  // A quarter turn about z, the end written as the opposite quaternion.
  add_channel(model, {0,
                      ChannelPath::kRotation,
                      Interpolation::kLinear,
                      {0, 1},
                      {0, 0, 0, 1, 0, 0, -half, -half},
                      4});
  const float angle = 0.25F * 1.5707963F;
  expect_near(origin_of(model, 1, 0.25F), {1 - 2 * std::sin(angle), 2 * std::cos(angle), 0});
}

TEST(Animate, CubicSplineFollowsHermite) {
  Model model = two_nodes();
  // One key: in-tangent, value, out-tangent. From 0 with slope 3 to 1 with slope 0 in two seconds.
  add_channel(model, {0,
                      ChannelPath::kTranslation,
                      Interpolation::kCubicSpline,
                      {0, 2},
                      {0, 0, 0, 0, 0, 0, 3, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0},
                      3});
  // h00 = h01 = 1/2, h10 = 1/8 at the middle: 1/2 + 2 * 3 / 8.
  expect_near(origin_of(model, 0, 1.0F), {1.25F, 0, 0});
  expect_near(origin_of(model, 0, 2.0F), {1, 0, 0});
}

TEST(Animate, SkinFollowsItsJointsAndNotItsNode) {
  Model model = two_nodes();
  Primitive primitive;
  primitive.shape = {{{1, 2, 0}, {0, 0, 1}, {}}, {{5, 5, 5}, {1, 0, 0}, {}}};
  primitive.joints = {{0, 1, 0, 0}, {1, 0, 0, 0}};
  primitive.joint_weights = {{0.5F, 0.5F, 0, 0}, {1, 0, 0, 0}};
  Skin skin;
  skin.joints = {0, 1};
  const ModelPose rest = evaluate_pose(model, -1, 0.0F);
  for (const int joint : skin.joints) {
    skin.joint_from_skin_bind.push_back(
        glm::inverse(rest.model_from_node[static_cast<std::size_t>(joint)]));
  }
  // In the bind pose nothing moves.
  const auto still = deform(primitive, {}, joint_matrices(skin, rest));
  expect_near(still[0].position, {1, 2, 0});
  // The child turned by a quarter about z carries what hangs on it alone, and half of the other.
  model.nodes[1].rest.rotation = glm::angleAxis(1.5707963F, glm::vec3(0, 0, 1));
  const auto turned = deform(primitive, {}, joint_matrices(skin, evaluate_pose(model, -1, 0.0F)));
  expect_near(turned[0].position, {1, 2, 0});  // lies in the joint
  expect_near(turned[1].position, {1 - 3, 2 + 4, 5});
  expect_near(turned[1].normal, {0, 1, 0});
}

TEST(Animate, MorphTargetsAddUpAndAreAnimated) {
  Model model = two_nodes();
  Primitive primitive = test::box_primitive(glm::vec3(1.0F));
  primitive.targets.resize(2);
  primitive.targets[0].positions.assign(primitive.shape.size(), glm::vec3(1, 0, 0));
  primitive.targets[1].positions.assign(primitive.shape.size(), glm::vec3(0, 2, 0));
  model.meshes.push_back({{primitive}, {0.5F, 0.0F}});
  model.materials.resize(1);
  model.nodes[0].mesh = 0;
  model.nodes[0].rest.translation = glm::vec3(0.0F);
  EXPECT_NEAR(model_bounds(model).max.x, 1.5F, 1e-6F);
  add_channel(model, {0, ChannelPath::kWeights, Interpolation::kLinear, {0, 1}, {0, 0, 1, 1}, 2});
  const Box box = pose_bounds(model, evaluate_pose(model, 0, 0.5F));
  EXPECT_NEAR(box.max.x, 1.5F, 1e-6F);
  EXPECT_NEAR(box.max.y, 2.0F, 1e-6F);
}

TEST(Animate, AnimatedNodeMovesOnTheScreenAsComputed) {
  Renderer renderer(test::renderer_options());
  auto model =
      test::one_primitive_model(test::box_primitive(glm::vec3(0.1F)), test::matte(glm::vec3(0.5F)));
  add_channel(
      *model,
      {0, ChannelPath::kTranslation, Interpolation::kLinear, {0, 2}, {0, 0, 0, 0.4F, 0, 0}, 3});
  Instance instance;
  instance.model = model;
  instance.animation = 0;
  instance.animation_time_s = 1.0F;
  instance.world_from_model[3] = glm::vec4(0, 0, 2.1F, 1);
  LayerScene scene;
  scene.instances.push_back(instance);
  scene.light = Light::uniform(glm::vec3(0.5F), test::no_sun());
  const Camera camera;
  const Layer layer = renderer.draw_layer(scene, camera);
  double sum = 0.0;
  double sum_u = 0.0;
  for (int u = 0; u < camera.width; ++u) {
    const double alpha = test::at(layer.rgba, u, 240, 3);
    sum += alpha;
    sum_u += alpha * u;
  }
  // Front face at z = 2, from x = 0.1 to 0.3; of the left side, at z up to 2.2, a strip shows.
  const double left = camera.fx * 0.1 / 2.2 + camera.cx;
  const double right = camera.fx * 0.3 / 2.0 + camera.cx;
  EXPECT_NEAR(sum_u / sum, 0.5 * (left + right), 0.1);
}

}  // namespace
}  // namespace planecast::render
