#include "render/software/mip_texture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace planecast::render {
namespace {

ImageU8 two_by_two() {
  ImageU8 image(2, 2, 1);
  image.pixels = {0, 200, 100, 40};
  return image;
}

TEST(MipTexture, BlendsAndWrapsAsOpenGlDoes) {
  MipTexture::Options options;
  const MipTexture repeated(two_by_two(), options);
  EXPECT_NEAR(repeated.sample({0.5F, 0.25F}, 0.0F)[0], 100.0F / 255.0F, 1e-5F);
  EXPECT_NEAR(repeated.sample({0.0F, 0.25F}, 0.0F)[0], 100.0F / 255.0F, 1e-5F) << "round the edge";
  EXPECT_NEAR(repeated.sample({-3.75F, 7.25F}, 0.0F)[0], 0.0F, 1e-5F);
  EXPECT_NEAR(repeated.sample({0.1F, 0.9F}, 1.0F)[0], 85.0F / 255.0F, 1e-5F) << "the mean of all";
  EXPECT_NEAR(repeated.sample({0.25F, 0.25F}, 0.5F)[0], 42.5F / 255.0F, 1e-5F) << "between levels";
  options.wrap_s = GL_CLAMP_TO_EDGE;
  options.wrap_t = GL_MIRRORED_REPEAT;
  const MipTexture clamped(two_by_two(), options);
  EXPECT_NEAR(clamped.sample({9.0F, 0.25F}, 0.0F)[0], 200.0F / 255.0F, 1e-5F);
  EXPECT_NEAR(clamped.sample({0.25F, -0.75F}, 0.0F)[0], 100.0F / 255.0F, 1e-5F);
  options.mag_filter = GL_NEAREST;
  const MipTexture nearest(two_by_two(), options);
  EXPECT_NEAR(nearest.sample({0.4F, 0.4F}, 0.0F)[0], 0.0F, 1e-6F);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_GE(repeated.sample({nan, 1e30F}, nan)[0], 0.0F) << "reads somewhere inside";
}

TEST(MipTexture, ColoursAreBlendedAsLight) {
  ImageU8 image(2, 1, 3);
  image.pixels = {0, 0, 0, 255, 255, 255};
  MipTexture::Options options;
  options.colors = options.decode = true;
  EXPECT_NEAR(MipTexture(image, options).sample({0.5F, 0.5F}, 0.0F)[0], 0.5F, 1e-5F);
  options.decode = false;
  EXPECT_NEAR(MipTexture(image, options).sample({0.5F, 0.5F}, 1.0F)[0], 188.0F / 255.0F, 1e-5F);
}

/// Every size, wrap and place at the borders, also where the coordinate is no ordinary number: the
/// sanitizers watch.
TEST(MipTexture, ReadsNothingBesideItsTexels) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinite = std::numeric_limits<float>::infinity();
  const std::vector<float> places = {0.0F,   1.0F,   -1.0F,    0.999999F, 1.0F - 1e-8F,
                                     -1e-9F, 7.5F,   infinite, nan,       -infinite,
                                     1e30F,  -1e30F, 0.5F};
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 5}, {3, 2}, {8, 8}, {5, 1}}) {
    ImageU8 image(width, height, 3);
    std::ranges::fill(image.pixels, std::uint8_t{51});
    for (const GLint wrap : {GL_REPEAT, GL_MIRRORED_REPEAT, GL_CLAMP_TO_EDGE}) {
      for (const GLint filter : {GL_NEAREST, GL_LINEAR, GL_LINEAR_MIPMAP_LINEAR}) {
        MipTexture::Options options;
        options.wrap_s = options.wrap_t = wrap;
        options.min_filter = filter;
        options.mag_filter = filter == GL_NEAREST ? GL_NEAREST : GL_LINEAR;
        const MipTexture texture(image, options);
        for (const float u : places) {
          for (const float v : places) {
            for (const float level : {-1.0F, 0.3F, 2.0F, 40.0F, infinite, nan}) {
              EXPECT_NEAR(texture.sample({u, v}, level).g, 0.2F, 1e-6F);
            }
          }
        }
      }
    }
  }
}

TEST(MipTexture, LogarithmIsClose) {
  for (float x = 1e-3F; x < 1e4F; x *= 1.07F) EXPECT_NEAR(fast_log2(x), std::log2(x), 5e-5F);
}

}  // namespace
}  // namespace planecast::render
