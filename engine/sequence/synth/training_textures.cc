#include "engine/sequence/synth/training_textures.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "engine/sequence/synth/noise.h"
#include "engine/sequence/synth/prints.h"
#include "engine/sequence/synth/random.h"

namespace planecast::engine::synth {
namespace {

constexpr int kSide = 128;
constexpr float kTile_m = 1.2F;  // what one repeat of a material shows

Color random_color(Random& random, double low = 0.03, double high = 0.85) {
  const double value = random.uniform(low, high);
  const double saturation = random.uniform() < 0.5 ? 0.25 * random.uniform() : random.uniform();
  Color color;
  for (int c = 0; c < 3; ++c) {
    color[c] = static_cast<float>(value * (1.0 - saturation * random.uniform()));
  }
  return color;
}

cv::Mat draw(const Texture& texture) {
  cv::Mat tile(kSide, kSide, CV_32FC3);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const Color color = texture((static_cast<float>(x) + 0.5F) * kTile_m / kSide,
                                  (static_cast<float>(y) + 0.5F) * kTile_m / kSide);
      tile.at<cv::Vec3f>(y, x) = {color.x(), color.y(), color.z()};
    }
  }
  return tile;
}

Texture stripes(const Color& a, const Color& b, float period, float share, bool across) {
  return [=](float u, float v) -> Color {
    const float at = (across ? u : v) / period;
    return at - std::floor(at) < share ? a : b;
  };
}

Texture checks(const Color& a, const Color& b, float period) {
  return [=](float u, float v) -> Color {
    const int cell = static_cast<int>(std::floor(u / period) + std::floor(v / period));
    return cell % 2 == 0 ? a : b;
  };
}

Texture dots(const Color& ground, const Color& dot, float period, float radius) {
  return [=](float u, float v) -> Color {
    const float x = u / period - std::floor(u / period) - 0.5F;
    const float y = v / period - std::floor(v / period) - 0.5F;
    return std::hypot(x, y) < radius ? dot : ground;
  };
}

/// Stains at every size, as on concrete or stone.
Texture clouds(const Color& a, const Color& b, float size, int octaves, std::uint32_t seed) {
  return [=](float u, float v) -> Color {
    const float t = 0.5F + 0.9F * fractal_noise(u / size, v / size, octaves, seed);
    return a + (b - a) * std::clamp(t, 0.0F, 1.0F);
  };
}

Texture pattern(Random& random) {
  const Color a = random_color(random);
  const Color b = random_color(random);
  const auto period = static_cast<float>(random.uniform(0.04, 0.4));
  switch (random.below(4)) {
    case 0:
      return stripes(a, b, period, static_cast<float>(random.uniform(0.2, 0.8)),
                     random.below(2) == 0);
    case 1:
      return checks(a, b, period);
    case 2:
      return dots(a, b, period, static_cast<float>(random.uniform(0.15, 0.45)));
    default:
      return clouds(a, b, period, 1 + random.below(4), static_cast<std::uint32_t>(random.next()));
  }
}

Texture random_wood(Random& random, bool boards) {
  WoodOptions options;
  options.light = random_color(random, 0.15, 0.8).cwiseProduct(Color(1.0F, 0.8F, 0.6F));
  options.dark = options.light * static_cast<float>(random.uniform(0.35, 0.9));
  options.board_width_m = static_cast<float>(random.uniform(0.06, 0.25));
  options.board_length_m = static_cast<float>(random.uniform(0.5, 2.5));
  options.gap_m = boards ? 0.006F : 0.0F;
  options.variation = static_cast<float>(random.uniform(0.0, 0.5));
  return wood(options, static_cast<std::uint32_t>(random.next()));
}

Texture random_texture(TileKind kind, Random& random) {
  const auto seed = static_cast<std::uint32_t>(random.next());
  const Color a = random_color(random);
  const Color b = random_color(random);
  const Color light = random_color(random, 0.35, 0.9);
  const int choice = random.below(6);
  switch (kind) {
    case TileKind::kWall:
      if (choice == 0) return bricks(a, light, seed);
      if (choice == 1) return pattern(random);
      if (choice == 2) return clouds(light, light * 0.75F, 0.6F, 5, seed);
      if (choice == 3) return tiles(light, light * 0.5F, 0.15F, seed);
      return plaster(light, seed);
    case TileKind::kFloor:
      if (choice < 2) return random_wood(random, true);
      if (choice == 2) {
        return tiles(a, b, static_cast<float>(random.uniform(0.15, 0.6)), seed);
      }
      if (choice == 3) return pattern(random);
      return choice == 4 ? carpet(a, b, seed) : clouds(a, a * 0.7F, 0.3F, 5, seed);
    case TileKind::kWood:
      if (choice == 0) return plain(a);
      if (choice == 1) return clouds(light, light * 0.9F, 0.4F, 3, seed);
      return random_wood(random, false);
    case TileKind::kCloth:
      if (choice < 2) return pattern(random);
      return choice < 5 ? fabric(a, seed) : carpet(a, b, seed);
    default:
      if (choice == 0) return plain(a);
      if (choice < 3) return clouds(a, b, static_cast<float>(random.uniform(0.05, 0.6)), 3, seed);
      return choice == 3 ? pattern(random) : mottled(a, a * 0.6F, 0.08F, seed);
  }
}

/// A print, or a screen: fields of colour with lines of text.
cv::Mat draw_print_tile(Random& random) {
  cv::Mat bgr = draw_print(static_cast<PrintKind>(random.below(8)), kSide, kSide, random.next());
  cv::Mat tile(kSide, kSide, CV_32FC3);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const auto& p = bgr.at<cv::Vec3b>(kSide - 1 - y, x);
      const Color color =
          color_from_srgb(static_cast<std::uint32_t>(p[2] << 16 | p[1] << 8 | p[0]));
      tile.at<cv::Vec3f>(y, x) = {color.x(), color.y(), color.z()};
    }
  }
  return tile;
}

}  // namespace

TilePyramid::TilePyramid(const cv::Mat& tile) {
  levels_.push_back(tile);
  while (levels_.back().cols > 1) {
    cv::Mat half;
    cv::resize(levels_.back(), half, {}, 0.5, 0.5, cv::INTER_AREA);
    levels_.push_back(half);
  }
}

Color TilePyramid::at(float u, float v, float footprint) const {
  const float texels = footprint * static_cast<float>(levels_[0].cols);
  const int wanted = texels <= 1.0F ? 0 : static_cast<int>(std::log2(texels) + 0.5F);
  const auto level =
      static_cast<std::size_t>(std::min(wanted, static_cast<int>(levels_.size()) - 1));
  const cv::Mat& image = levels_[level];
  const int side = image.cols;
  // Mirrored repeats have no seams.
  const auto fold = [side](float x) {
    const float two = x - 2.0F * std::floor(0.5F * x);
    const float one = two > 1.0F ? 2.0F - two : two;
    return one * static_cast<float>(side) - 0.5F;
  };
  const float x = std::clamp(fold(u), 0.0F, static_cast<float>(side - 1));
  const float y = std::clamp(fold(v), 0.0F, static_cast<float>(side - 1));
  const int ix = std::min(static_cast<int>(x), std::max(side - 2, 0));
  const int iy = std::min(static_cast<int>(y), std::max(side - 2, 0));
  const int jx = std::min(ix + 1, side - 1);
  const int jy = std::min(iy + 1, side - 1);
  const float tx = x - static_cast<float>(ix);
  const float ty = y - static_cast<float>(iy);
  const auto texel = [&image](int row, int col) {
    return Eigen::Map<const Color>(image.ptr<float>(row) + 3 * col);
  };
  const Color low = texel(iy, ix) + (texel(iy, jx) - texel(iy, ix)) * tx;
  const Color high = texel(jy, ix) + (texel(jy, jx) - texel(jy, ix)) * tx;
  return low + (high - low) * ty;
}

const TilePyramid& TileBank::tile(TileKind kind, int index) {
  const int at = static_cast<int>(kind) * per_kind_ + index % per_kind_;
  std::unique_ptr<TilePyramid>& tile = tiles_[static_cast<std::size_t>(at)];
  if (tile == nullptr) {
    Random random(named_seed("training tile", seed_ * 4096U + static_cast<std::uint64_t>(at)));
    tile = std::make_unique<TilePyramid>(
        kind == TileKind::kPrint ? draw_print_tile(random) : draw(random_texture(kind, random)));
  }
  return *tile;
}

}  // namespace planecast::engine::synth
