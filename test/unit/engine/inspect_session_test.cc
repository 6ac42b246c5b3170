#include "engine/inspect/session.h"

#include <gtest/gtest.h>

#include "engine/assets.h"
#include "engine/scene/write_scene_file.h"
#include "test/unit/engine/output_test_files.h"
#include "test/unit/engine/table_world.h"

namespace planecast::engine {
namespace {

/// Raw pixel of a point of the table world as its first frame sees it.
Eigen::Vector2d pixel_of(const Reconstruction& world, const Eigen::Vector3d& point) {
  return world.camera.project(world.frames.front().world_from_cam->inverse() * point);
}

class Session : public ::testing::Test {
 protected:
  InspectSession open(const SceneFile& scene = {}) {
    return InspectSession(table_world(), scene, folder_ / "scene.yaml",
                          {asset("models/block.glb"), asset("models/vase.glb")});
  }
  const TestFolder folder_;
  const Eigen::Vector3d on_table_{0.1, 0.5, 1.5};
  const Eigen::Vector3d beside_on_table_{-0.3, 0.5, 1.7};
  const Eigen::Vector2d table_ = pixel_of(table_world(), on_table_);
  const Eigen::Vector2d beside_ = pixel_of(table_world(), beside_on_table_);
};

TEST_F(Session, ScrubbingStaysInsideTheSequence) {
  InspectSession session = open();
  EXPECT_EQ(session.frame().index, 10);
  session.step(1);
  EXPECT_EQ(session.frame().index, 11);
  session.step(100);
  EXPECT_EQ(session.frame().index, 12);
  session.step(-100);
  EXPECT_EQ(session.frame().index, 10);
  session.go_to_frame(11);
  EXPECT_EQ(session.frame().index, 11);
  session.go_to_frame(9999);
  EXPECT_EQ(session.frame().index, 12);
  session.go_to_frame(0);
  EXPECT_EQ(session.frame().index, 10);
}

TEST_F(Session, AClickPlacesTheModelOnThePlaneUnderIt) {
  InspectSession session = open();
  session.tool = InspectTool::kPlace;
  session.model = 1;
  ASSERT_TRUE(session.click(table_)) << session.message();
  ASSERT_EQ(session.objects().size(), 1U);
  EXPECT_EQ(session.objects()[0].plane, 1);
  EXPECT_EQ(session.objects()[0].name, "vase");
  const PlacedObject& placed = session.content().items[0].placed;
  const auto anchor = placed.anchor.world_from_anchor(session.reconstruction().planes);
  EXPECT_LT((anchor->translation() - on_table_).norm(), 1e-4);
  EXPECT_EQ(session.selected(), 0U);
  EXPECT_TRUE(session.unsaved());
  EXPECT_EQ(session.tool, InspectTool::kMove) << "a second click must not place another";
}

TEST_F(Session, PlacingWhereNothingIsChangesNothingAndSaysWhy) {
  Reconstruction world = table_world();
  world.planes.erase(world.planes.begin() + 2);  // without the wall a ray upwards meets nothing
  InspectSession session(world, {}, folder_ / "scene.yaml", {asset("models/block.glb")});
  session.tool = InspectTool::kPlace;
  EXPECT_FALSE(session.click({320.0, 5.0}));
  EXPECT_TRUE(session.objects().empty());
  EXPECT_FALSE(session.unsaved());
  EXPECT_NE(session.message().find("there is no plane"), std::string::npos) << session.message();
  session.go_to_frame(11);
  EXPECT_FALSE(session.place(table_));
  EXPECT_NE(session.message().find("no camera pose"), std::string::npos) << session.message();
}

TEST_F(Session, DraggingMovesTheObjectAlongItsPlane) {
  InspectSession session = open();
  session.place(table_);
  session.begin_drag();
  ASSERT_TRUE(session.drag_to(beside_)) << session.message();
  const auto anchor =
      session.content().items[0].placed.anchor.world_from_anchor(session.reconstruction().planes);
  EXPECT_LT((anchor->translation() - beside_on_table_).norm(), 1e-4);
  ASSERT_TRUE(session.undo());
  const auto& place = std::get<PixelPlace>(session.scene().objects[0].place);
  EXPECT_NEAR(place.pixel.x(), table_.x(), 0.01);
}

TEST_F(Session, ScalingAndTurning) {
  InspectSession session = open();
  session.place(table_);
  session.set_size(0.2);
  EXPECT_NEAR(session.content().items[0].longest_side, 0.2, 1e-9);
  session.scale_by(1.5);
  EXPECT_NEAR(session.content().items[0].longest_side, 0.3, 1e-9);
  session.rotate_by(190.0);
  EXPECT_NEAR(session.scene().objects[0].yaw_deg, -170.0, 1e-9);
}

TEST_F(Session, WithoutASizeScalingBeginsWithTheModelsOwn) {
  InspectSession session = open();
  session.place(table_);
  const double own = session.content().items[0].longest_side;
  EXPECT_NEAR(session.selected_size(), own, 1e-9);
  session.scale_by(2.0);
  EXPECT_NEAR(session.content().items[0].longest_side, 2.0 * own, 1e-9);
}

TEST_F(Session, ClicksSelectTheNearestObjectElseThePlane) {
  InspectSession session = open();
  session.place(table_);
  session.set_size(0.2);
  session.place(beside_);
  session.set_size(0.2);
  const Eigen::Vector2d above =
      pixel_of(session.reconstruction(), on_table_ + Eigen::Vector3d(0, -0.05, 0));
  session.click(above);
  EXPECT_EQ(session.selected(), 0U);
  session.click(pixel_of(session.reconstruction(), {2.0, -0.5, 4.0}));
  EXPECT_FALSE(session.selected());
  EXPECT_EQ(session.chosen_plane(), 2);
}

TEST_F(Session, UndoAndRedoGoThroughEveryStep) {
  InspectSession session = open();
  session.place(table_);
  session.place(beside_);
  session.remove_selected();
  EXPECT_EQ(session.objects().size(), 1U);
  session.undo();
  EXPECT_EQ(session.objects().size(), 2U);
  session.undo();
  session.undo();
  EXPECT_TRUE(session.objects().empty());
  EXPECT_FALSE(session.undo());
  session.redo();
  session.redo();
  session.redo();
  EXPECT_EQ(session.objects().size(), 1U);
  EXPECT_FALSE(session.redo());
}

TEST_F(Session, WhatIsSavedIsReadBackTheSame) {
  InspectSession session = open();
  session.place(table_);
  session.set_size(0.25);
  session.rotate_by(33.0);
  session.go_to_frame(12);
  session.place(beside_);
  ASSERT_TRUE(session.save()) << session.message();
  EXPECT_FALSE(session.unsaved());

  InspectSession again = open(read_scene_file(session.scene_path()));
  ASSERT_EQ(again.objects().size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_TRUE(again.objects()[i].world_from_model.matrix() ==
                session.objects()[i].world_from_model.matrix());
  }
  EXPECT_EQ(scene_yaml(again.scene(), folder_.path()), scene_yaml(session.scene(), folder_.path()));
}

TEST_F(Session, AnEmptySceneIsNotSaved) {
  InspectSession session = open();
  EXPECT_FALSE(session.save());
  EXPECT_FALSE(std::filesystem::exists(session.scene_path()));
}

}  // namespace
}  // namespace planecast::engine
