#include "engine/scene/placement.h"

#include <gtest/gtest.h>

#include <numbers>

#include "engine/scene/default_scene.h"
#include "engine/scene/metric_scale.h"
#include "engine/scene/plane_outline.h"
#include "engine/user_error.h"
#include "table_world.h"

namespace planecast::engine {
namespace {

constexpr double kExact = 1e-9;  // double arithmetic on a scene of a few metres

/// A model 0.4 wide, 0.8 high and 0.2 deep whose base centre is not its origin.
const ModelBox kBox(Eigen::Vector3d(-0.1, 0.1, -0.1), Eigen::Vector3d(0.3, 0.9, 0.1));
const SizeUnit kMetres{1.0, 2.0};

SceneObject object_at(const Place& place) {
  SceneObject object;
  object.model = "m.glb";
  object.place = place;
  object.where = "s.yaml:1";
  return object;
}

PixelPlace tap_on_table() { return {10, {319.5 + 500.0 * 0.2 / 1.6, 239.5 + 500.0 * 0.5 / 1.6}}; }

const MarkerMap kNoMarkers;

PlacedObject place(const Reconstruction& world, const SceneObject& object,
                   const SizeUnit& unit = kMetres) {
  return place_object({world, false, kNoMarkers}, object, kBox, unit);
}

SizeUnit unit_of(const Reconstruction& world, const SceneFile& scene,
                 const MarkerMap& markers = kNoMarkers) {
  return size_unit({world, false, markers}, scene, scene.objects[0]);
}

Eigen::Affine3d placed_pose(const Reconstruction& world, const SceneObject& object) {
  return *place(world, object).world_from_model(world.planes);
}

TEST(Placement, StandsOnThePlaneFacingTheCamera) {
  const Reconstruction world = table_world();
  SceneObject object = object_at(tap_on_table());
  object.size = 0.4;
  const Eigen::Affine3d world_from_model = placed_pose(world, object);
  // The base's centre is on the tapped point, the top 0.4 m above it along the plane's normal.
  EXPECT_LT(
      (world_from_model * Eigen::Vector3d(0.1, 0.1, 0.0) - Eigen::Vector3d(0.2, 0.5, 1.6)).norm(),
      kExact);
  EXPECT_LT(
      (world_from_model * Eigen::Vector3d(0.1, 0.9, 0.0) - Eigen::Vector3d(0.2, 0.1, 1.6)).norm(),
      kExact);
  // All four base corners lie on the plane.
  for (const double x : {-0.1, 0.3}) {
    for (const double z : {-0.1, 0.1}) {
      EXPECT_NEAR((world_from_model * Eigen::Vector3d(x, 0.1, z)).y(), 0.5, kExact);
    }
  }
  const Eigen::Vector3d front = (world_from_model.linear() * Eigen::Vector3d::UnitZ()).normalized();
  const Eigen::Vector3d to_camera = Eigen::Vector3d(-0.2, 0.0, -1.6).normalized();
  EXPECT_LT((front - to_camera).norm(), kExact);
  EXPECT_GT(world_from_model.linear().determinant(), 0.0);
}

TEST(Placement, YawTurnsCounterClockwiseSeenFromAbove) {
  const Reconstruction world = table_world();
  SceneObject object = object_at(tap_on_table());
  const Eigen::Vector3d before = placed_pose(world, object).linear() * Eigen::Vector3d::UnitZ();
  object.yaw_deg = 90.0;
  const Eigen::Vector3d after = placed_pose(world, object).linear() * Eigen::Vector3d::UnitZ();
  EXPECT_LT((before.cross(after).normalized() - world.planes[1].normal).norm(), kExact);
  EXPECT_NEAR(before.dot(after), 0.0, kExact);
}

TEST(Placement, KeepFollowsThePlanesAxis) {
  const Reconstruction world = table_world();
  SceneObject object = object_at(tap_on_table());
  object.face = Face::kKeep;
  const Eigen::Vector3d x = placed_pose(world, object).linear() * Eigen::Vector3d::UnitX();
  EXPECT_LT((x.normalized() - world.planes[1].x_axis).norm(), kExact);
}

TEST(Placement, HangsOnWallsUpright) {
  const Reconstruction world = table_world();
  const SceneObject object = object_at(PlanePlace{"largest-vertical", {0.5, 0.5}});
  const PlacedObject placed = place(world, object);
  EXPECT_TRUE(placed.hangs);
  const Eigen::Affine3d world_from_model = *placed.world_from_model(world.planes);
  // The centre of the back touches the wall's middle, front to the room, top up.
  EXPECT_LT(
      (world_from_model * Eigen::Vector3d(0.1, 0.5, -0.1) - Eigen::Vector3d(0.0, 0.05, 4.0)).norm(),
      kExact);
  EXPECT_LT(
      (world_from_model.linear() * Eigen::Vector3d::UnitZ() - Eigen::Vector3d(0, 0, -1)).norm(),
      kExact);
  EXPECT_LT(
      (world_from_model.linear() * Eigen::Vector3d::UnitY() - Eigen::Vector3d(0, -1, 0)).norm(),
      kExact);
}

TEST(Placement, SizesCountInMetresOrMedianDepths) {
  Reconstruction world = table_world();
  SceneObject object = object_at(tap_on_table());
  const auto scale = [&](const SizeUnit& unit) { return place(world, object, unit).scale; };
  EXPECT_NEAR(scale(kMetres), 1.0, kExact);                  // its own size
  EXPECT_NEAR(scale({0.0, 2.0}), 0.25 * 2.0 / 0.8, kExact);  // a quarter of the median depth
  object.size = 0.4;
  EXPECT_NEAR(scale(kMetres), 0.5, kExact);
  EXPECT_NEAR(scale({3.0, 2.0}), 1.5, kExact);
  EXPECT_NEAR(scale({0.0, 2.0}), 1.0, kExact);
}

TEST(Placement, AnchorsFollowTheirPlane) {
  Reconstruction world = table_world();
  const PlacedObject placed = place(world, object_at(tap_on_table()));
  const slam::Pose before = *placed.anchor.world_from_anchor(world.planes);
  // A correction moves and turns the plane: content keeps its place and its upright stand on it.
  slam::Pose correction = slam::Pose::Identity();
  correction.rotate(Eigen::AngleAxisd(0.2, Eigen::Vector3d(1, 2, 3).normalized()));
  correction.pretranslate(Eigen::Vector3d(0.3, -0.1, 0.2));
  PlaneRecord& table = plane_by_id(world, 1);
  table.normal = correction.linear() * table.normal;
  table.x_axis = correction.linear() * table.x_axis;
  table.origin = correction * table.origin;
  table.offset = -table.normal.dot(table.origin);
  const slam::Pose after = *placed.anchor.world_from_anchor(world.planes);
  EXPECT_LT(((correction * before).matrix() - after.matrix()).norm(), kExact);
  EXPECT_NEAR(table.normal.dot(after.translation()) + table.offset, 0.0, kExact);
  world.planes.erase(world.planes.begin() + 1);
  EXPECT_FALSE(placed.anchor.world_from_anchor(world.planes).has_value());
}

TEST(Placement, MergesReExpressAnchors) {
  Reconstruction world = table_world();
  const PlacedObject placed = place(world, object_at(tap_on_table()));
  PlaneRecord other = plane_by_id(world, 1);
  other.id = 9;
  other.origin += Eigen::Vector3d(0.4, 0.0, -0.2);
  other.x_axis = Eigen::Vector3d::UnitZ();
  const Anchor moved = move_anchor(placed.anchor, plane_by_id(world, 1), other);
  EXPECT_EQ(moved.plane_id, 9);
  EXPECT_LT((moved.world_from_anchor({other})->matrix() -
             placed.anchor.world_from_anchor(world.planes)->matrix())
                .norm(),
            kExact);
}

TEST(Placement, RulesFindTheirPlanes) {
  const Reconstruction world = table_world();
  EXPECT_EQ(select_plane(world, "largest-horizontal", "t").id, 0);
  EXPECT_EQ(select_plane(world, "floor", "t").id, 0);
  EXPECT_EQ(select_plane(world, "nearest", "t").id, 1);
  EXPECT_EQ(select_plane(world, "2", "t").id, 2);
  try {
    select_plane(world, "7", "s.yaml:4");
    FAIL();
  } catch (const UserError& error) {
    EXPECT_STREQ(error.what(),
                 "s.yaml:4: there is no plane '7'; planes: 0 (floor), 1 (horizontal), 2 (wall)");
  }
}

TEST(MetricScale, KnownLengthsGiveMetres) {
  Reconstruction world = table_world();
  world.metric = false;
  SceneFile scene;
  scene.objects.push_back(object_at(tap_on_table()));
  EXPECT_EQ(unit_of(world, scene).units_per_metre, 0.0);
  EXPECT_EQ(unit_of(world, scene).median_depth, 2.0);
  // The camera is 0.5 units above the table; the user measured 1.25 m.
  scene.scale = ScaleHint{PlaneDistanceScale{1.25, std::nullopt}, "s.yaml:9"};
  EXPECT_NEAR(unit_of(world, scene).units_per_metre, 0.4, kExact);
  EdgeScale edge;
  edge.frame = 10;
  edge.from = world.camera.project({-0.3, 0.5, 1.5});
  edge.to = world.camera.project({0.3, 0.5, 1.5});
  edge.length_m = 1.2;
  scene.scale->rule = edge;
  EXPECT_NEAR(unit_of(world, scene).units_per_metre, 0.5, kExact);
  // A bottle stands on the table, 0.3 units high; the user knows that it is 0.25 m.
  HeightScale bottle;
  bottle.frame = 10;
  bottle.foot = world.camera.project({0.1, 0.5, 1.5});
  bottle.top = world.camera.project({0.1, 0.2, 1.5});
  bottle.height_m = 0.25;
  scene.scale->rule = bottle;
  EXPECT_NEAR(unit_of(world, scene).units_per_metre, 1.2, kExact);
  // The cameras are 1.3 units above the floor.
  scene.scale->rule = CameraHeightScale{1.625, std::nullopt};
  EXPECT_NEAR(unit_of(world, scene).units_per_metre, 0.8, kExact);
  scene.scale->rule = CameraHeightScale{1.625, 12};
  EXPECT_NEAR(unit_of(world, scene).units_per_metre, 0.8, kExact);
  scene.scale->rule = MarkerScale{0.1, {"4x4_50", 3}};
  MarkerMap markers;
  markers[{"4x4_50", 3}].corners = {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.2, 0, 0),
                                    Eigen::Vector3d(0.2, 0, 0.2), Eigen::Vector3d(0, 0, 0.2)};
  EXPECT_NEAR(unit_of(world, scene, markers).units_per_metre, 2.0, kExact);
  EXPECT_THROW(unit_of(world, scene), UserError);
}

TEST(Placement, SizesCanNameTheirUnit) {
  const Reconstruction world = table_world();
  SceneObject object = object_at(tap_on_table());
  object.size = 0.4;
  object.unit = LengthUnit::kRelative;
  EXPECT_NEAR(place(world, object).scale, 0.4 * 2.0 / 0.8, kExact);
  object.unit = LengthUnit::kMetres;
  EXPECT_NEAR(place(world, object, {3.0, 2.0}).scale, 1.5, kExact);
  EXPECT_THROW(place(world, object, {0.0, 2.0}), UserError);
}

TEST(Placement, OffsetsGoAlongTheObjectsOwnAxes) {
  const Reconstruction world = table_world();
  SceneObject object = object_at(tap_on_table());
  const Eigen::Affine3d before = placed_pose(world, object);
  object.offset = Eigen::Vector3d(0.1, 0.05, 0.2);
  object.yaw_deg = 30.0;
  const Eigen::Affine3d after = placed_pose(world, object);
  // Without a size the model keeps its own scale of 1, and metres are world units.
  const Eigen::Vector3d moved =
      after * Eigen::Vector3d(0.1, 0.1, 0.0) - before * Eigen::Vector3d(0.1, 0.1, 0.0);
  EXPECT_LT((moved - after.linear() * object.offset).norm(), kExact);
}

TEST(Placement, StacksStandOnWhatIsBelow) {
  const Reconstruction world = table_world();
  const PlacedObject base = place(world, object_at(tap_on_table()));
  SceneObject upper = object_at(ObjectPlace{"base"});
  upper.size = 0.4;
  upper.yaw_deg = 90.0;
  const PlacedObject placed = place_object({world, false, kNoMarkers}, upper, kBox, kMetres, &base);
  const Eigen::Vector3d foot =
      *placed.world_from_model(world.planes) * Eigen::Vector3d(0.1, 0.1, 0.0);
  EXPECT_LT((foot - Eigen::Vector3d(0.2, 0.5 - 0.8, 1.6)).norm(), kExact);
  EXPECT_THROW(place(world, upper), UserError);
}

TEST(Placement, MarkersCarryTheirOwnAxes) {
  const Reconstruction world = table_world();
  MarkerMap markers;
  FoundMarker& marker = markers[{"4x4_50", 3}];
  marker.plane_id = 1;
  const Eigen::Vector3d centre(0.1, 0.5, 1.4);
  const Eigen::Vector3d right = Eigen::Vector3d(1, 0, 1).normalized() * 0.05;
  const Eigen::Vector3d up = Eigen::Vector3d(-1, 0, 1).normalized() * 0.05;
  marker.corners = {centre - right + up, centre + right + up, centre + right - up,
                    centre - right - up};
  SceneObject object = object_at(MarkerPlace{{"4x4_50", 3}});
  object.face = Face::kKeep;
  const PlacedObject placed = place_object({world, false, markers}, object, kBox, kMetres);
  EXPECT_EQ(placed.anchor.plane_id, 1);
  const Eigen::Affine3d pose = *placed.world_from_model(world.planes);
  EXPECT_LT((pose * Eigen::Vector3d(0.1, 0.1, 0.0) - centre).norm(), kExact);
  EXPECT_LT((pose.linear() * Eigen::Vector3d::UnitX() - right.normalized()).norm(), kExact);
  EXPECT_THROW(place(world, object), UserError);
}

TEST(DefaultScene, PutsTheStandingModelOnTheTableInView) {
  Reconstruction world = table_world();
  // Look down at the table from a metre away, as one does.
  for (FrameRecord& frame : world.frames) {
    if (frame.world_from_cam) {
      frame.world_from_cam->translation() += Eigen::Vector3d(-0.1, -0.4, 0.3);
      frame.world_from_cam->rotate(Eigen::AngleAxisd(-0.6, Eigen::Vector3d::UnitX()));
    }
  }
  DefaultSceneOptions options;
  options.standing_model = "stand.glb";
  options.hanging_model = "hang.glb";
  const SceneFile scene = default_scene(world, options);
  ASSERT_EQ(scene.objects.size(), 1U);
  EXPECT_EQ(scene.objects[0].model, "stand.glb");
  EXPECT_EQ(std::get<PlanePlace>(scene.objects[0].place).plane, "1");
  const PlacedObject placed = place(world, scene.objects[0]);
  const PlaneOutline outline = plane_outline(world.planes[1]);
  const Eigen::Vector2d at = placed.anchor.plane_from_anchor.translation().head<2>();
  EXPECT_TRUE(contains(outline, at));
  EXPECT_GT(distance_to_edge(outline, at), 0.2);
  EXPECT_GT(*scene.objects[0].size, 0.1);
  EXPECT_LT(*scene.objects[0].size, 0.6);
}

TEST(DefaultScene, TakesAWallWhenThereIsNothingElse) {
  Reconstruction world = table_world();
  world.planes.erase(world.planes.begin(), world.planes.begin() + 2);
  DefaultSceneOptions options;
  options.hanging_model = "hang.glb";
  EXPECT_EQ(default_scene(world, options).objects[0].model, "hang.glb");
  world.planes.clear();
  EXPECT_THROW(default_scene(world, options), UserError);
}

TEST(DefaultScene, TakesASmallPlaneAtTheSideWhenTheMiddleShowsNone) {
  Reconstruction world = table_world();
  world.planes = {make_plane(7, level_ring(0.5, 0.8, 0.9, 1.3, 1.6), -Eigen::Vector3d::UnitY(),
                             Eigen::Vector3d::UnitX())};
  world.planes[0].plane_class = "horizontal";
  const SceneFile scene = default_scene(world, DefaultSceneOptions());
  EXPECT_EQ(std::get<PlanePlace>(scene.objects[0].place).plane, "7");
}

}  // namespace
}  // namespace planecast::engine
