#include "engine/calibrate/calibrate.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "engine/calibrate/view_selection.h"
#include "engine/sequence/camera_file.h"
#include "engine/user_error.h"

namespace planecast::engine {
namespace {

constexpr int kTexelsPerSquare = 48;
constexpr int kSamples = 2;  ///< a side, in a pixel

/// Pictures of a board by a known camera.
class BoardRenderer {
 public:
  BoardRenderer(const slam::Camera& camera, const BoardSpec& spec)
      : camera_(camera), spec_(spec), page_(BoardDetector(spec).draw(kTexelsPerSquare)) {
    for (int y = 0; y < kSamples * camera.height; ++y) {
      for (int x = 0; x < kSamples * camera.width; ++x) {
        const Eigen::Vector2d raw((x + 0.5) / kSamples - 0.5, (y + 0.5) / kSamples - 0.5);
        rays_.push_back(camera.ray(camera.undistort(raw)));
      }
    }
  }

  /// `cam_from_board` maps squares; the board's centre is its origin here.
  cv::Mat draw(const Eigen::Isometry3d& cam_from_board) const {
    const Eigen::Isometry3d board_from_cam = cam_from_board.inverse();
    const Eigen::Vector3d eye = board_from_cam.translation();
    cv::Mat fine(kSamples * camera_.height, kSamples * camera_.width, CV_8UC1);
    for (int y = 0; y < fine.rows; ++y) {
      for (int x = 0; x < fine.cols; ++x) {
        const auto index = static_cast<std::size_t>(y) * static_cast<std::size_t>(fine.cols) +
                           static_cast<std::size_t>(x);
        const Eigen::Vector3d ray = board_from_cam.linear() * rays_[index];
        const double distance = -eye.z() / ray.z();
        const Eigen::Vector3d hit = eye + distance * ray;
        fine.at<std::uint8_t>(y, x) = distance > 0.0 ? colour(hit.x(), hit.y()) : 90;
      }
    }
    cv::Mat picture;
    cv::resize(fine, picture, cv::Size(camera_.width, camera_.height), 0, 0, cv::INTER_AREA);
    cv::cvtColor(picture, picture, cv::COLOR_GRAY2BGR);
    return picture;
  }

 private:
  std::uint8_t colour(double x, double y) const {
    // The page has a margin of half a square.
    const int col =
        static_cast<int>(std::floor((x + 0.5 * spec_.columns + 0.5) * kTexelsPerSquare));
    const int row = static_cast<int>(std::floor((y + 0.5 * spec_.rows + 0.5) * kTexelsPerSquare));
    if (col < 0 || row < 0 || col >= page_.cols || row >= page_.rows) return 90;
    return page_.at<std::uint8_t>(row, col);
  }

  slam::Camera camera_;
  BoardSpec spec_;
  cv::Mat page_;
  std::vector<Eigen::Vector3d> rays_;
};

/// Views from all sides: the board's centre moves over the picture, its slant goes round.
std::vector<Eigen::Isometry3d> poses(int count, double distance, double reach_x, double reach_y,
                                     double slant_deg) {
  std::vector<Eigen::Isometry3d> result;
  for (int i = 0; i < count; ++i) {
    // An additive sequence in two dimensions fills the picture evenly.
    const double across = 2.0 * std::fmod(0.5 + 0.7548776662 * i, 1.0) - 1.0;
    const double down = 2.0 * std::fmod(0.5 + 0.5698402910 * i, 1.0) - 1.0;
    const double depth = distance * (1.0 + 0.15 * (i % 3));
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() = Eigen::Vector3d(reach_x * across, reach_y * down, depth);
    const Eigen::Vector3d axis(std::cos(1.7 * i), std::sin(1.7 * i), 0.2 * (i % 2));
    pose.linear() =
        Eigen::AngleAxisd(slant_deg * M_PI / 180.0, axis.normalized()).toRotationMatrix();
    result.push_back(pose);
  }
  return result;
}

std::filesystem::path record(const std::string& name, const BoardRenderer& renderer,
                             const std::vector<Eigen::Isometry3d>& views) {
  const std::filesystem::path folder = testing::TempDir() + "calibrate_" + name;
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  for (std::size_t i = 0; i < views.size(); ++i) {
    cv::imwrite((folder / (std::to_string(100 + i) + ".png")).string(), renderer.draw(views[i]));
  }
  return folder;
}

Calibration calibrate(const std::filesystem::path& folder, const BoardSpec& spec,
                      slam::LensModel lens) {
  CalibrateOptions options;
  options.lens = lens;
  const auto recording = open_sequence(folder, {});
  return calibrate_camera(*recording, spec, options, nullptr);
}

/// Focal lengths and centre within 0.5 %, and the lens maps every pixel to within `most_px`.
void expect_same(const slam::Camera& found, const slam::Camera& truth, double most_px) {
  EXPECT_NEAR(found.fx, truth.fx, 0.005 * truth.fx);
  EXPECT_NEAR(found.fy, truth.fy, 0.005 * truth.fy);
  EXPECT_NEAR(found.cx, truth.cx, 0.005 * truth.width);
  EXPECT_NEAR(found.cy, truth.cy, 0.005 * truth.width);
  EXPECT_EQ(found.width, truth.width);
  EXPECT_EQ(found.lens, truth.lens);
  for (int y = 20; y < truth.height; y += 40) {
    for (int x = 20; x < truth.width; x += 40) {
      const Eigen::Vector3d ray = truth.ray(truth.undistort({x, y}));
      const Eigen::Vector2d again = found.distort(found.project(ray));
      EXPECT_LT((again - Eigen::Vector2d(x, y)).norm(), most_px) << x << " " << y;
    }
  }
}

slam::Camera barrel_camera() {
  slam::Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = 520.0;
  camera.fy = 515.0;
  camera.cx = 326.0;
  camera.cy = 235.0;
  camera.distortion = {-0.24, 0.07, 0.001, -0.0008, 0.0};
  return camera;
}

slam::Camera fisheye_camera() {
  slam::Camera camera;
  camera.lens = slam::LensModel::kFisheye;
  camera.width = 640;
  camera.height = 480;
  camera.fx = 300.0;
  camera.fy = 298.0;
  camera.cx = 318.0;
  camera.cy = 243.0;
  camera.distortion = {0.03, -0.012, 0.004, -0.001, 0.0};
  return camera;
}

TEST(Calibrate, FindsAPinholeCameraFromAChessboard) {
  const slam::Camera truth = barrel_camera();
  const BoardSpec spec;
  const BoardRenderer renderer(truth, spec);
  const auto folder = record("pinhole", renderer, poses(30, 13.0, 4.0, 3.4, 32.0));
  const Calibration found = calibrate(folder, spec, truth.lens);
  EXPECT_GE(found.found, 15);
  EXPECT_LT(found.rms_px, 0.15);
  EXPECT_GT(found.coverage, 0.6);
  ASSERT_TRUE(found.focal_uncertainty);
  EXPECT_LT(*found.focal_uncertainty, 0.005);
  EXPECT_TRUE(found.warnings.empty()) << found.warnings.front();
  expect_same(found.camera, truth, 0.5);
}

TEST(Calibrate, FindsAFisheyeCameraFromACharucoBoardSeenInPart) {
  const slam::Camera truth = fisheye_camera();
  BoardSpec spec;
  spec.kind = BoardKind::kCharuco;
  spec.columns = 8;
  spec.rows = 6;
  const BoardRenderer renderer(truth, spec);
  const auto folder = record("fisheye", renderer, poses(45, 5.0, 4.8, 3.8, 30.0));
  const Calibration found = calibrate(folder, spec, truth.lens);
  const auto in_part = [](const CalibrationView& view) { return view.corners.board.size() < 35; };
  EXPECT_GT(std::ranges::count_if(found.views, in_part), 0);
  EXPECT_LT(found.rms_px, 0.3);
  // A shift of its centre is nearly a turn of a camera so wide, which corners seen in part leave
  // open by half a pixel and more.
  expect_same(found.camera, truth, 1.0);
}

TEST(Calibrate, WarnsOfFrontalViewsInTheMiddle) {
  const BoardSpec spec;
  const BoardRenderer renderer(barrel_camera(), spec);
  const auto folder = record("frontal", renderer, poses(5, 22.0, 0.4, 0.4, 3.0));
  const Calibration found = calibrate(folder, spec, slam::LensModel::kPinhole);
  std::string all;
  for (const std::string& warning : found.warnings) all += warning + "\n";
  EXPECT_NE(all.find("only 5 views"), std::string::npos) << all;
  EXPECT_NE(all.find("% of the picture"), std::string::npos) << all;
  EXPECT_NE(all.find("tilt it"), std::string::npos) << all;
}

TEST(Calibrate, AViewThatDoesNotFitIsDropped) {
  const slam::Camera truth = barrel_camera();
  std::vector<CalibrationView> views;
  for (const Eigen::Isometry3d& pose : poses(12, 14.0, 3.0, 2.0, 30.0)) {
    CalibrationView view;
    for (int row = 1; row < 7; ++row) {
      for (int col = 1; col < 10; ++col) {
        const Eigen::Vector3d corner = pose * Eigen::Vector3d(col - 5.0, row - 3.5, 0.0);
        const Eigen::Vector2d pixel = truth.distort(truth.project(corner));
        view.corners.board.emplace_back(static_cast<float>(col), static_cast<float>(row), 0.0F);
        view.corners.image.emplace_back(static_cast<float>(pixel.x()),
                                        static_cast<float>(pixel.y()));
      }
    }
    views.push_back(view);
  }
  // As after a blur: every second corner is 6 px off.
  for (std::size_t i = 0; i < views[4].corners.image.size(); i += 2) {
    views[4].corners.image[i].x += 6.0F;
  }
  const Calibration found = calibrate_from_views(views, {640, 480}, {});
  EXPECT_EQ(found.rejected, 1);
  EXPECT_EQ(found.views.size(), 11U);
  EXPECT_LT(found.rms_px, 0.01);
  expect_same(found.camera, truth, 0.5);
}

TEST(Calibrate, NoBoardIsOneLine) {
  const std::filesystem::path folder = testing::TempDir() + "calibrate_none";
  std::filesystem::create_directories(folder);
  cv::imwrite((folder / "grey.png").string(), cv::Mat(120, 160, CV_8UC3, cv::Scalar(90, 90, 90)));
  try {
    calibrate(folder, BoardSpec{}, slam::LensModel::kPinhole);
    FAIL() << "a board was found in a grey picture";
  } catch (const UserError& error) {
    EXPECT_NE(std::string(error.what()).find("calibrate_none"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("0 frames"), std::string::npos) << error.what();
  }
}

TEST(Calibrate, RefusesImpossibleBoards) {
  BoardSpec spec;
  spec.columns = 2;
  EXPECT_THROW(BoardDetector{spec}, UserError);
  spec.kind = BoardKind::kCharuco;
  spec.columns = 20;
  spec.rows = 20;
  EXPECT_THROW(BoardDetector{spec}, UserError);  // 200 markers of 50
  spec.dictionary = "4x4_250";
  EXPECT_NO_THROW(BoardDetector{spec});
}

TEST(Calibrate, TheFileCanBeReadBackAndSaysHowGoodItIs) {
  const std::filesystem::path file = testing::TempDir() + "calibrated.yaml";
  CameraSettings settings;
  settings.camera = barrel_camera();
  write_camera_file(file, settings, "reprojection RMS 0.2 px\ncoverage 80 %");
  EXPECT_DOUBLE_EQ(read_camera_file(file).camera.fx, 520.0);
  std::ifstream in(file);
  std::string first;
  std::getline(in, first);
  EXPECT_EQ(first, "# reprojection RMS 0.2 px");
}

TEST(SelectViews, PrefersDifferentOnes) {
  std::vector<BoardView> views;
  // Ten times nearly the same place, then four others.
  for (int i = 0; i < 14; ++i) {
    const float x = i < 10 ? 100.0F + static_cast<float>(i) : 100.0F * static_cast<float>(i - 8);
    BoardView view;
    for (int k = 0; k < 9; ++k) {
      view.board.emplace_back(static_cast<float>(k % 3), static_cast<float>(k / 3), 0.0F);
      view.image.emplace_back(x + 20.0F * static_cast<float>(k % 3),
                              200.0F + 20.0F * static_cast<float>(k / 3));
    }
    views.push_back(view);
  }
  const std::vector<int> chosen = select_views(views, {640, 480}, 5);
  ASSERT_EQ(chosen.size(), 5U);
  for (const int index : {10, 11, 12, 13}) {
    EXPECT_NE(std::ranges::find(chosen, index), chosen.end()) << index;
  }
}

}  // namespace
}  // namespace planecast::engine
