#include <fmt/format.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "engine/sequence/camera_file.h"
#include "engine/sequence/groundtruth.h"
#include "engine/sequence/sequence.h"
#include "sequence_test_files.h"

/// Small folders in the layout of each public data set, with what its files are known for.
namespace planecast::engine {
namespace {

namespace fs = std::filesystem;

constexpr double kExact = 1e-9;

void write_image(const fs::path& file, const cv::Mat& image) {
  fs::create_directories(file.parent_path());
  ASSERT_TRUE(cv::imwrite(file.string(), image));
}

cv::Mat depth_of(int units) { return {48, 64, CV_16U, cv::Scalar(units)}; }

/// TUM RGB-D: three comment lines, irregular times of their own in every list, a colour image whose
/// depth is lost, motion capture at 100 Hz.
void write_tum(const TestFolder& folder) {
  std::string rgb =
      "# color images\n# file: 'rgbd_dataset_freiburg1_xyz.bag'\n"
      "# timestamp filename\n";
  std::string depth =
      "# depth maps\n# file: 'rgbd_dataset_freiburg1_xyz.bag'\n"
      "# timestamp filename\n";
  const char* rgb_times[] = {"1305031102.175304", "1305031102.211214", "1305031102.275326",
                             "1305031102.311214"};
  // 15 ms early, 19.9 ms late, lost, 21 ms late.
  const char* depth_times[] = {"1305031102.160407", "1305031102.231100", "", "1305031102.332300"};
  for (int i = 0; i < 4; ++i) {
    write_image(folder.path() / fmt::format("rgb/{}.png", rgb_times[i]), test_picture(i));
    rgb += fmt::format("{0} rgb/{0}.png\n", rgb_times[i]);
    if (depth_times[i][0] == '\0') continue;
    write_image(folder.path() / fmt::format("depth/{}.png", depth_times[i]), depth_of(5000 + i));
    depth += fmt::format("{0} depth/{0}.png\n", depth_times[i]);
  }
  folder.write("rgb.txt", rgb);
  folder.write("depth.txt", depth);
  folder.write("groundtruth.txt",
               "# ground truth trajectory\n# file: 'rgbd_dataset_freiburg1_xyz.bag'\n"
               "# timestamp tx ty tz qx qy qz qw\n"
               "1305031102.1758 1.3405 0.6266 1.6575 0.6574 0.6126 -0.2949 -0.3248\n"
               "1305031102.1859 1.3405 0.6266 1.6575 0.6574 0.6126 -0.2949 -0.3248\n");
}

TEST(TumDataset, PairsWithinTwentyMillisecondsAndFactor5000) {
  TestFolder folder;
  write_tum(folder);
  SequenceOptions options;
  options.camera = "tum-fr1";
  const auto sequence = open_sequence(folder.path(), options);
  ASSERT_EQ(sequence->end_frame(), 4);
  EXPECT_NEAR(sequence->timestamp(1), 1305031102.211214, 1e-6);
  ASSERT_FALSE(sequence->read(0).depth.empty());
  ASSERT_FALSE(sequence->read(1).depth.empty());
  EXPECT_NEAR(sequence->read(0).depth.at<float>(5, 5), 5000.0 / 5000.0, 1e-6);
  EXPECT_NEAR(sequence->read(1).depth.at<float>(5, 5), 5001.0 / 5000.0, 1e-6);
  EXPECT_TRUE(sequence->read(2).depth.empty());  // lost
  EXPECT_TRUE(sequence->read(3).depth.empty());  // 21 ms apart
  EXPECT_TRUE(sequence->camera().has_distortion());
  EXPECT_DOUBLE_EQ(sequence->camera().fx, 517.3 / 10.0);  // 64 of 640 pixels
  const auto truth = read_groundtruth(folder.path());
  ASSERT_EQ(truth.size(), 2U);
  EXPECT_NEAR(truth[0].world_from_cam.translation().z(), 1.6575, kExact);
}

TEST(TumDataset, PresetsOfTheThreeCameras) {
  // The calibration file's figures (Sturm et al. 2012): fr1 and fr2 are distorted, fr3 is
  // rectified.
  for (const auto& [name, fx, distorted] :
       {std::tuple{"tum-fr1", 517.3, true}, std::tuple{"tum-fr2", 520.9, true},
        std::tuple{"tum-fr3", 535.4, false}}) {
    const auto preset = camera_preset(name);
    ASSERT_TRUE(preset) << name;
    EXPECT_DOUBLE_EQ(preset->camera.fx, fx);
    EXPECT_EQ(preset->camera.has_distortion(), distorted) << name;
    EXPECT_DOUBLE_EQ(preset->depth_factor, 5000.0);
  }
}

/// ICL-NUIM's PNG packages: numbered images, associations with depth first, a trajectory whose
/// times are frame numbers that begin at 1, a y axis that points up.
TEST(IclDataset, NumbersBecomeTimesAndTheCameraIsItsOwn) {
  TestFolder folder;
  std::string associations;
  for (int i = 0; i < 3; ++i) {
    write_image(folder.path() / fmt::format("rgb/{}.png", i), test_picture(i));
    write_image(folder.path() / fmt::format("depth/{}.png", i), depth_of(10000));
    associations += fmt::format("{0} depth/{0}.png {0} rgb/{0}.png\n", i);
  }
  folder.write("associations.txt", associations);
  folder.write("livingRoom0n.gt.sim", "1 0 0 0\n0 1 0 0\n0 0 1 -2.25\n\n");
  folder.write("livingRoom0.gt.freiburg",
               "1 0 0 -2.25 0 0 0 1\n2 0.000466347 0.00895357 -2.24935 -0.00101358 "
               "0.00052453 -0.000231475 0.999999\n");
  const auto sequence = open_sequence(folder.path(), {});
  ASSERT_EQ(sequence->end_frame(), 3);
  EXPECT_TRUE(sequence->warnings().empty());  // no guess
  EXPECT_DOUBLE_EQ(sequence->camera().fy, -480.0 / 10.0);
  EXPECT_DOUBLE_EQ(sequence->camera().fx, 481.2 / 10.0);
  EXPECT_FLOAT_EQ(sequence->read(1).depth.at<float>(2, 2), 2.0F);
  const auto truth = read_groundtruth(folder.path());
  ASSERT_EQ(truth.size(), 2U);
  // Pose 1 belongs to image 1, not to the first image.
  EXPECT_NEAR(truth[0].timestamp, sequence->timestamp(1), kExact);
  EXPECT_NEAR(truth[1].timestamp, sequence->timestamp(2), kExact);
  EXPECT_NEAR(truth[0].world_from_cam.translation().z(), -2.25, kExact);
}

TEST(IclDataset, AssociationsOfTumsToolKeepTheirTimes) {
  TestFolder folder;
  write_image(folder.path() / "rgb/a.png", test_picture(1));
  write_image(folder.path() / "rgb/b.png", test_picture(2));
  write_image(folder.path() / "depth/a.png", depth_of(5000));
  folder.write("associations.txt",
               "10.50 rgb/a.png 10.51 depth/a.png\n10.53 rgb/b.png 10.55 depth/a.png\n");
  const auto sequence = open_sequence(folder.path(), {});
  EXPECT_NEAR(sequence->timestamp(0), 10.5, kExact);
  EXPECT_TRUE(sequence->camera().guessed);
}

/// EuRoC: nanoseconds, a header with blanks, Windows line ends, the body's pose as truth.
TEST(EurocDataset, NanosecondsSensorFileAndBodyPoses) {
  TestFolder folder;
  folder.write("mav0/cam0/data.csv",
               "#timestamp [ns],filename\r\n1403636579763555584,1403636579763555584.png\r\n"
               "1403636579813555456,1403636579813555456.png\r\n");
  for (const char* name : {"1403636579763555584", "1403636579813555456"}) {
    write_image(folder.path() / fmt::format("mav0/cam0/data/{}.png", name),
                cv::Mat(48, 75, CV_8U, cv::Scalar(90)));
  }
  folder.write("mav0/cam0/sensor.yaml",
               "#Default configuration\nsensor_type: camera\ncomment: VI-Sensor cam0\n"
               "T_BS:\n  cols: 4\n  rows: 4\n"
               "  data: [0.0, -1.0, 0.0, 0.5,\n         1.0, 0.0, 0.0, 0.0,\n"
               "         0.0, 0.0, 1.0, 0.0,\n         0.0, 0.0, 0.0, 1.0]\n"
               "rate_hz: 20\nresolution: [752, 480]\ncamera_model: pinhole\n"
               "intrinsics: [458.654, 457.296, 367.215, 248.375] #fu, fv, cu, cv\n"
               "distortion_model: radial-tangential\n"
               "distortion_coefficients: [-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05]\n");
  folder.write("mav0/state_groundtruth_estimate0/data.csv",
               "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], "
               "q_RS_y [], q_RS_z [], v_RS_R_x [m s^-1]\n"
               "1403636579768555584,1.0,2.0,3.0,1.0,0.0,0.0,0.0,0.1\n");
  const auto sequence = open_sequence(folder.path(), {});
  EXPECT_NEAR(sequence->timestamp(0), 1403636579.763555584, 1e-6);
  EXPECT_NEAR(sequence->camera().fx, 458.654 * 75.0 / 752.0, 1e-6);
  EXPECT_TRUE(sequence->camera().has_distortion());
  EXPECT_EQ(sequence->read(1).image.type(), CV_8UC3);  // grey is brought to colour
  const auto truth = read_groundtruth(folder.path());
  ASSERT_EQ(truth.size(), 1U);
  EXPECT_NEAR(truth[0].timestamp, 1403636579.768555584, 1e-6);  // 5 ms from its image
  // The camera sits 0.5 m along the body's x and is turned by 90 degrees about z.
  EXPECT_LT((truth[0].world_from_cam.translation() - Eigen::Vector3d(1.5, 2.0, 3.0)).norm(),
            kExact);
  EXPECT_LT((truth[0].world_from_cam.linear().col(0) - Eigen::Vector3d::UnitY()).norm(), kExact);
  folder.write("mav0/cam0/sensor.yaml", "intrinsics: [1, 1, 1, 1]\n");
  EXPECT_NE(user_error([&] { read_groundtruth(folder.path()); }).find("'T_BS' is missing"),
            std::string::npos);
}

/// 7-Scenes: three files a frame, millimetres, 65535 for no measurement, tabs in the matrices, a
/// frame that could not be located.
TEST(SevenScenesDataset, MillimetresAndMatrices) {
  TestFolder folder;
  for (int i = 0; i < 3; ++i) {
    const std::string stem = fmt::format("frame-{:06d}", i);
    write_image(folder.path() / (stem + ".color.png"), test_picture(i));
    cv::Mat depth = depth_of(1500 + i);
    depth.at<std::uint16_t>(7, 9) = 65535;
    depth.at<std::uint16_t>(8, 9) = 0;
    if (i != 1) write_image(folder.path() / (stem + ".depth.png"), depth);
    const std::string row = i == 2 ? "-1.#IND\t-1.#IND\t-1.#IND\t-1.#IND\t\n"
                                   : " 0.0000000e+000\t-1.0000000e+000\t 0.0\t 0.25\t\n";
    folder.write(stem + ".pose.txt",
                 row + "1.0\t0.0\t0.0\t-0.5\t\n0.0\t0.0\t1.0\t2.0\t\n0.0\t0.0\t0.0\t1.0\t\n");
  }
  const auto sequence = open_sequence(folder.path(), {});
  ASSERT_EQ(sequence->end_frame(), 3);  // depth images are not frames
  EXPECT_DOUBLE_EQ(sequence->timestamp(2), 0.066667);
  EXPECT_TRUE(sequence->warnings().empty());  // its own preset,
  EXPECT_TRUE(sequence->camera().guessed);    // whose figures are nominal and may be refined
  EXPECT_DOUBLE_EQ(sequence->camera().fx, 525.0 / 10.0);
  const slam::FrameInput frame = sequence->read(0);
  EXPECT_FLOAT_EQ(frame.depth.at<float>(3, 3), 1.5F);
  EXPECT_FLOAT_EQ(frame.depth.at<float>(7, 9), 0.0F);
  EXPECT_FLOAT_EQ(frame.depth.at<float>(8, 9), 0.0F);
  EXPECT_TRUE(sequence->read(1).depth.empty());
  const auto truth = read_groundtruth(folder.path());
  ASSERT_EQ(truth.size(), 2U);
  EXPECT_NEAR(truth[1].timestamp, sequence->timestamp(1), kExact);
  EXPECT_LT((truth[0].world_from_cam.translation() - Eigen::Vector3d(0.25, -0.5, 2.0)).norm(),
            kExact);
  folder.write("frame-000001.pose.txt", "1 0 0\n");
  EXPECT_NE(user_error([&] { read_groundtruth(folder.path()); }).find("expected a 4x4 matrix"),
            std::string::npos);
}

TEST(GroundTruth, OfAFolderWithoutIsOneLine) {
  TestFolder folder;
  folder.write("notes.txt", "nothing");
  EXPECT_EQ(find_groundtruth(folder.path()), std::nullopt);
  EXPECT_EQ(user_error([&] { read_groundtruth(folder.path()); }),
            folder.path().string() + ": holds no true poses");
}

}  // namespace
}  // namespace planecast::engine
