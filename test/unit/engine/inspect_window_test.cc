#include "engine/inspect/window.h"

#include <gtest/gtest.h>
#include <imgui.h>

#include "engine/assets.h"
#include "engine/gui/gui_context.h"
#include "engine/inspect/screen.h"
#include "test/unit/engine/output_test_files.h"
#include "test/unit/engine/table_world.h"

namespace planecast::engine {
namespace {

constexpr int kWidth = 1000;
constexpr int kHeight = 640;

/// The window without OpenGL, driven as by a mouse.
class Window : public ::testing::Test {
 protected:
  Window()
      : session_(table_world(), {}, folder_ / "scene.yaml", {asset("models/block.glb")}),
        window_(session_, {}, 30.0),
        gui_(16.0F) {
    draw(3);
  }

  void draw(int pictures) {
    for (int i = 0; i < pictures; ++i) {
      gui_.begin(kWidth, kHeight);
      window_.draw();
      gui_.end();
    }
  }
  void move_to(const ImVec2& at) {
    gui_.make_current();
    ImGui::GetIO().MousePos = at;
    draw(2);
  }
  void press(bool down) {
    gui_.make_current();
    ImGui::GetIO().MouseDown[0] = down;
    draw(2);
  }
  void click(const ImVec2& at) {
    move_to(at);
    press(true);
    press(false);
  }
  void wheel(float notches) {
    gui_.make_current();
    ImGui::GetIO().MouseWheel = notches;
    draw(1);
  }
  ImVec2 on_picture(const Eigen::Vector3d& world) const {
    const slam::Pose& pose = *session_.frame().world_from_cam;
    return window_.picture_area().to_canvas(
        session_.reconstruction().camera.project(pose.inverse() * world));
  }
  ImVec2 middle(const InspectRect& rect) const {
    return {rect.x + 0.5F * rect.width, rect.y + 0.5F * rect.height};
  }

  const TestFolder folder_;
  InspectSession session_;
  InspectWindow window_;
  GuiContext gui_;
};

TEST_F(Window, ClickingThePictureWithThePlaceToolPutsTheModelThere) {
  session_.tool = InspectTool::kPlace;
  click(on_picture({0.1, 0.5, 1.5}));
  ASSERT_EQ(session_.objects().size(), 1U) << session_.message();
  EXPECT_EQ(session_.objects()[0].plane, 1);
  const Eigen::Affine3d& at = session_.objects()[0].world_from_model;
  EXPECT_LT(
      (at * session_.content().items[0].placed.contact - Eigen::Vector3d(0.1, 0.5, 1.5)).norm(),
      0.005);
}

TEST_F(Window, DraggingInThePictureMovesTheSelectedObject) {
  session_.place({320.0, 400.0});
  session_.set_size(0.2);
  const Eigen::Vector3d before = session_.objects()[0].world_from_model.translation();
  const auto& place = std::get<PixelPlace>(session_.scene().objects[0].place);
  const ImVec2 grip = window_.picture_area().to_canvas(place.pixel - Eigen::Vector2d(0.0, 10.0));
  move_to(grip);
  press(true);
  move_to({grip.x + 60.0F, grip.y});
  press(false);
  const Eigen::Vector3d moved = session_.objects()[0].world_from_model.translation() - before;
  EXPECT_GT(moved.x(), 0.05);
  EXPECT_EQ(session_.objects().size(), 1U);
  session_.undo();
  EXPECT_LT((session_.objects()[0].world_from_model.translation() - before).norm(), 1e-9)
      << "one drag is one step";
}

TEST_F(Window, TheWheelScalesTheSelectedObject) {
  session_.place({320.0, 400.0});
  const double before = session_.selected_size();
  move_to(middle(inspect_layout(kWidth, kHeight).picture));
  wheel(1.0F);
  EXPECT_GT(session_.selected_size(), 1.02 * before);
}

TEST_F(Window, ClickingTheLaneScrubs) {
  const InspectRect lane = inspect_layout(kWidth, kHeight).timeline;
  const float below = lane.y + lane.height - 20.0F;
  click({lane.x + lane.width - 20.0F, below});
  EXPECT_EQ(session_.frame().index, 12);
  click({lane.x + 0.5F * lane.width, below});
  EXPECT_EQ(session_.frame().index, 11);
}

TEST_F(Window, DraggingTheMapTurnsItAndTheWheelZooms) {
  const ImVec2 at = middle(inspect_layout(kWidth, kHeight).map);
  const Eigen::Matrix3d before = window_.map_camera().world_from_camera().linear();
  const double distance = window_.map_camera().distance();
  move_to(at);
  press(true);
  move_to({at.x + 50.0F, at.y});
  press(false);
  const Eigen::AngleAxisd turn(before.transpose() *
                               window_.map_camera().world_from_camera().linear());
  EXPECT_GT(turn.angle(), 0.2);
  wheel(2.0F);
  EXPECT_LT(window_.map_camera().distance(), 0.9 * distance);
}

TEST_F(Window, PlayingGoesRoundAtTheSequencesSpeed) {
  window_.view().playing = true;
  draw(2);  // two sixtieths of a second are one frame of 30 a second
  EXPECT_EQ(session_.position(), 1);
  draw(4);
  EXPECT_EQ(session_.position(), 0);
}

TEST(FramePictures, AnObjectThatGrewLooksAsOneThatWasAlwaysSoLarge) {
  const TestFolder folder;
  InspectSession session(table_world(), {}, folder / "scene.yaml", {asset("models/block.glb")});
  ASSERT_TRUE(session.place({320.0, 400.0})) << session.message();
  ASSERT_TRUE(session.set_size(0.05)) << session.message();
  FramePictures frames(session, nullptr);
  const cv::Mat small = frames.picture(true).clone();
  ASSERT_TRUE(session.set_size(0.5)) << session.message();
  FramePictures fresh(session, nullptr);
  EXPECT_GT(cv::norm(frames.picture(true), small, cv::NORM_INF), 20.0);
  EXPECT_EQ(cv::norm(frames.picture(true), fresh.picture(true), cv::NORM_INF), 0.0);
}

TEST(Screen, SameSessionSamePicture) {
  const TestFolder folder;
  cv::Mat pictures[2];
  for (cv::Mat& picture : pictures) {
    InspectSession session(table_world(), {}, folder / "scene.yaml", {asset("models/block.glb")});
    ASSERT_TRUE(session.place({320.0, 400.0})) << session.message();
    FramePictures frames(session, nullptr);
    InspectWindow window(session, {}, 30.0);
    InspectScreen screen(window, frames);
    picture = inspect_screenshot(screen, kWidth, kHeight);
  }
  ASSERT_EQ(pictures[0].size(), cv::Size(kWidth, kHeight));
  EXPECT_EQ(cv::norm(pictures[0], pictures[1], cv::NORM_INF), 0.0);
  cv::Mat mean;
  cv::Mat spread;
  cv::meanStdDev(pictures[0], mean, spread);
  EXPECT_GT(spread.at<double>(0), 5.0) << "an empty picture";
}

}  // namespace
}  // namespace planecast::engine
