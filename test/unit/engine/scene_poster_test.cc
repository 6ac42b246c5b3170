#include "engine/scene/poster.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "engine/output/png.h"
#include "engine/output/video.h"
#include "engine/user_error.h"
#include "output_test_files.h"
#include "render/gltf/import.h"

namespace planecast::engine {
namespace {

int mean_red(const render::Model& model) {
  const render::ImageU8& image = model.images.at(0);
  long sum = 0;
  for (std::size_t i = 0; i < image.pixels.size(); i += 3) sum += image.pixels[i];
  return static_cast<int>(sum / (static_cast<long>(image.width) * image.height));
}

TEST(Poster, APictureIsABoardOfItsShape) {
  const TestFolder folder;
  cv::Mat picture(50, 100, CV_8UC3, cv::Scalar(0, 0, 200));
  picture.rowRange(0, 10).setTo(cv::Scalar(255, 255, 255));
  write_png(picture, folder / "p.png");
  PosterPrint print({folder / "p.png", false});
  EXPECT_NEAR(print.height(), 0.5, 1e-9);
  const auto model = print.at(3.0, true);
  const render::Bounds bounds = render::model_bounds(*model);
  EXPECT_NEAR(bounds.max.x - bounds.min.x, 1.0F, 1e-6F);
  EXPECT_NEAR(bounds.max.y - bounds.min.y, 0.5F, 1e-6F);
  EXPECT_NEAR(bounds.min.z, 0.0F, 1e-6F);
  // The picture's first row, white, is on the front's upper edge.
  const render::Primitive& front = model->meshes.at(0).primitives.at(0);
  for (std::size_t i = 0; i < front.shape.size(); ++i) {
    EXPECT_EQ(front.surface[i].uv0.y, front.shape[i].position.y > 0.25F ? 0.0F : 1.0F);
    EXPECT_GT(front.shape[i].normal.z, 0.99F);
  }
  EXPECT_EQ(model->images.at(0).pixels.at(1), 255);
  EXPECT_THROW(PosterPrint({folder / "none.png", false}), UserError);
}

TEST(Poster, AVideoShowsTheFrameOfItsTimeAndLoops) {
  const TestFolder folder;
  {
    VideoWriter video(folder / "v.mp4", 64, 48, 10.0, {});
    for (int i = 0; i < 5; ++i) {
      video.write(cv::Mat(48, 64, CV_8UC3, cv::Scalar(20, 20, 40 * (i + 1))));
    }
    video.finish();
  }
  PosterPrint print({folder / "v.mp4", true});
  const auto red_at = [&](double time, bool loop) { return mean_red(*print.at(time, loop)); };
  EXPECT_NEAR(red_at(0.0, true), 40, 8);  // what the codec leaves of it
  EXPECT_NEAR(red_at(0.31, true), 160, 8);
  EXPECT_NEAR(red_at(0.39, true), 160, 8);
  EXPECT_NEAR(red_at(0.5, true), 40, 8);
  EXPECT_NEAR(red_at(1.71, true), 120, 8);
  EXPECT_NEAR(red_at(1.71, false), 200, 8);
  // Within one frame's time it is the same model, so that nothing is uploaded anew.
  const auto first = print.at(0.31, true);
  EXPECT_EQ(first, print.at(0.39, true));
}

}  // namespace
}  // namespace planecast::engine
