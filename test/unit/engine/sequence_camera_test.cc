#include <gtest/gtest.h>

#include "engine/sequence/camera_file.h"
#include "sequence_test_files.h"

namespace planecast::engine {
namespace {

TEST(CameraFile, ReadsWhatItWrites) {
  TestFolder folder;
  CameraSettings settings;
  settings.camera.lens = slam::LensModel::kFisheye;
  settings.camera.width = 320;
  settings.camera.height = 240;
  settings.camera.fx = 211.25;
  settings.camera.fy = -210.5;
  settings.camera.cx = 159.5;
  settings.camera.cy = 1.0 / 3.0;
  settings.camera.distortion = {0.1, -0.02, 0.003, 1e-7, 0};
  settings.fps = 29.97;
  settings.depth_factor = 1000;
  write_camera_file(folder.path() / "c.yaml", settings);
  const CameraSettings read = load_camera((folder.path() / "c.yaml").string());
  EXPECT_EQ(read.camera.lens, slam::LensModel::kFisheye);
  EXPECT_EQ(read.camera.width, 320);
  EXPECT_EQ(read.camera.height, 240);
  EXPECT_EQ(read.camera.fx, 211.25);
  EXPECT_EQ(read.camera.fy, -210.5);
  EXPECT_EQ(read.camera.cy, 1.0 / 3.0);
  EXPECT_EQ(read.camera.distortion, settings.camera.distortion);
  EXPECT_EQ(read.fps, 29.97);
  EXPECT_EQ(read.depth_factor, 1000);
}

TEST(CameraFile, ReadsOpenCvCalibration) {
  TestFolder folder;
  const auto file = folder.write("c.yaml", R"(%YAML:1.0
---
calibration_time: "today"
image_width: 1280
image_height: 720
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 9.5e+02, 0., 6.395e+02, 0., 9.51e+02, 3.595e+02, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ 1.0e-01, -2.0e-01, 1.0e-03, -1.0e-03, 5.0e-02 ]
)");
  const slam::Camera camera = read_camera_file(file).camera;
  EXPECT_EQ(camera.width, 1280);
  EXPECT_EQ(camera.fx, 950.0);
  EXPECT_EQ(camera.fy, 951.0);
  EXPECT_EQ(camera.cx, 639.5);
  EXPECT_EQ(camera.cy, 359.5);
  EXPECT_EQ(camera.distortion, (std::array<double, 5>{0.1, -0.2, 0.001, -0.001, 0.05}));
}

TEST(CameraFile, ReadsRosAndEurocFiles) {
  TestFolder folder;
  const auto ros = folder.write("ros.yaml", R"(image_width: 640
image_height: 480
camera_matrix: {rows: 3, cols: 3, data: [500, 0, 320, 0, 501, 240, 0, 0, 1]}
distortion_model: equidistant
distortion_coefficients: {rows: 1, cols: 4, data: [0.1, 0.2, 0.3, 0.4]}
)");
  EXPECT_EQ(read_camera_file(ros).camera.lens, slam::LensModel::kFisheye);
  EXPECT_EQ(read_camera_file(ros).camera.distortion[3], 0.4);
  const auto euroc = folder.write("sensor.yaml", R"(sensor_type: camera
resolution: [752, 480]
camera_model: pinhole
intrinsics: [458.654, 457.296, 367.215, 248.375]
distortion_model: radial-tangential
distortion_coefficients: [-0.28, 0.07, 0.0002, 0.00002]
)");
  EXPECT_EQ(read_camera_file(euroc).camera.cx, 367.215);
  EXPECT_EQ(read_camera_file(euroc).camera.width, 752);
}

TEST(CameraFile, PresetsAreThere) {
  EXPECT_EQ(camera_preset_names().size(), 6u);
  EXPECT_EQ(load_camera("7scenes").depth_factor, 1000.0);
  EXPECT_EQ(load_camera("icl-nuim").camera.fy, -480.0);
  EXPECT_EQ(load_camera("tum-fr1").camera.distortion[4], 1.1633);
  EXPECT_FALSE(camera_preset("tum-fr9"));
}

TEST(CameraFile, ErrorsNameFileAndReason) {
  TestFolder folder;
  const auto reason = [&folder](const std::string& text) {
    const auto file = folder.write("bad.yaml", text);
    const std::string message = user_error([&file] { read_camera_file(file); });
    EXPECT_EQ(message.find(file.string()), 0u) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    return message;
  };
  const std::string good = "width: 64\nheight: 48\nfx: 50\nfy: 50\ncx: 32\ncy: 24\n";
  EXPECT_NE(reason("width: 64\n").find("'height' is missing"), std::string::npos);
  EXPECT_NE(reason(good + "focal: 3\n").find("unknown key 'focal'"), std::string::npos);
  EXPECT_NE(reason(good + "model: mirror\n").find("mirror"), std::string::npos);
  EXPECT_NE(reason(good + "distortion: 7\n").find("list"), std::string::npos);
  EXPECT_NE(reason(good + "fps: fast\n").find("'fps' must be a number"), std::string::npos);
  EXPECT_NE(reason(good + "depth_factor: 0\n").find("positive"), std::string::npos);
  EXPECT_NE(reason("width: [1\n").find("YAML"), std::string::npos);
  EXPECT_NE(reason("").find("not a camera file"), std::string::npos);
  EXPECT_NE(reason("fx: .nan\n" + good.substr(0, 21) + "fy: 1\ncx: 1\ncy: 1\n").find("finite"),
            std::string::npos);
  EXPECT_NE(user_error([] { load_camera("no-such-thing"); }).find("not a preset"),
            std::string::npos);
}

TEST(CameraFile, ScalesToImagesOfTheSameShapeOnly) {
  const slam::Camera camera = load_camera("tum-fr3").camera;
  const slam::Camera half = fit_camera_to_images(camera, 320, 240, "tum-fr3");
  EXPECT_DOUBLE_EQ(half.fx, camera.fx / 2);
  EXPECT_DOUBLE_EQ(half.cx, (camera.cx + 0.5) / 2 - 0.5);
  EXPECT_NE(user_error([&] {
              fit_camera_to_images(camera, 640, 360, "tum-fr3");
            }).find("tum-fr3: the camera is 640x480, but the images are 640x360"),
            std::string::npos);
}

}  // namespace
}  // namespace planecast::engine
