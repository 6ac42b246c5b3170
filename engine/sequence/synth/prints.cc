#include "engine/sequence/synth/prints.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "engine/sequence/synth/noise.h"
#include "engine/sequence/synth/random.h"

namespace planecast::engine::synth {

namespace {

using Palette = std::array<std::uint32_t, 5>;

// Paper first, ink second, then three accents.
constexpr Palette kPalettes[] = {
    {0xF2E9D8, 0x22303C, 0xD9573F, 0xE8B04A, 0x3F7F86},
    {0xEFE6D9, 0x2B2A33, 0x365F8C, 0xD98C5F, 0xA8B8A0},
    {0xF4EEE2, 0x1F2A2E, 0x2F6B5E, 0xE2B25B, 0xC8553D},
    {0xE9E4DB, 0x30262B, 0x8C3F4F, 0x4E7A9A, 0xE6C27A},
};

const Palette& palette_of(Random& random) { return kPalettes[random.below(4)]; }

cv::Scalar bgr(std::uint32_t rgb) {
  return {static_cast<double>(rgb & 0xFF), static_cast<double>(rgb >> 8 & 0xFF),
          static_cast<double>(rgb >> 16 & 0xFF)};
}

/// A word-like string; the prints are meant to be seen, not read.
std::string word(Random& random, int syllables) {
  static const char* const kSyllables[] = {"ka",  "lo", "min", "ter", "sa",  "ven", "ri",  "do",
                                           "ple", "on", "na",  "ber", "tis", "mu",  "gra", "el"};
  std::string text;
  for (int i = 0; i < syllables; ++i) text += kSyllables[random.below(16)];
  return text;
}

void put_text(cv::Mat& image, const std::string& text, cv::Point at, double height_px,
              const cv::Scalar& color, int face = cv::FONT_HERSHEY_DUPLEX, double weight = 0.12) {
  const double scale = height_px / 22.0;  // Hershey capitals are about 22 px high at scale 1
  const int thickness = std::max(1, static_cast<int>(std::lround(weight * height_px)));
  cv::putText(image, text, at, face, scale, color, thickness, cv::LINE_AA);
}

/// Lines of words filling a rectangle.
void put_column(cv::Mat& image, cv::Rect box, double line_px, const cv::Scalar& ink,
                Random& random) {
  const double letter_px = 0.55 * line_px;
  for (double y = box.y + line_px; y <= box.y + box.height; y += line_px) {
    double x = box.x;
    const bool last_of_paragraph = random.below(7) == 0;
    const double end = box.x + box.width * (last_of_paragraph ? random.uniform(0.3, 0.8) : 1.0);
    while (x < end) {
      const std::string text = word(random, 1 + random.below(3));
      const double length = 0.62 * letter_px * static_cast<double>(text.size());
      if (x + length > box.x + box.width) break;
      put_text(image, text, cv::Point(static_cast<int>(x), static_cast<int>(y)), letter_px, ink,
               cv::FONT_HERSHEY_SIMPLEX, 0.10);
      x += length + 0.7 * letter_px;
    }
  }
}

void add_paper_grain(cv::Mat& image, std::uint32_t seed) {
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const float grain = 1.0F + 0.035F * (cell_random(x, y, seed) - 0.5F) +
                          0.04F * smooth_noise(0.02F * static_cast<float>(x),
                                               0.02F * static_cast<float>(y), seed + 1);
      auto& pixel = image.at<cv::Vec3b>(y, x);
      for (int c = 0; c < 3; ++c) pixel[c] = cv::saturate_cast<unsigned char>(pixel[c] * grain);
    }
  }
}

void draw_shapes(cv::Mat& image, Random& random) {
  const Palette& p = palette_of(random);
  const int w = image.cols;
  const int h = image.rows;
  image = bgr(p[0]);
  for (int i = 0; i < 11; ++i) {
    const cv::Scalar color = bgr(p[static_cast<std::size_t>(1 + random.below(4))]);
    const cv::Point at(static_cast<int>(random.uniform(0.12, 0.88) * w),
                       static_cast<int>(random.uniform(0.12, 0.72) * h));
    const int size = static_cast<int>(random.uniform(0.05, 0.21) * w);
    switch (random.below(4)) {
      case 0:
        cv::circle(image, at, size, color, cv::FILLED, cv::LINE_AA);
        break;
      case 1:
        cv::ellipse(image, at, {size, size}, 45.0 * random.below(8), 0, 180, color, cv::FILLED,
                    cv::LINE_AA);
        break;
      case 2:
        cv::rectangle(image, cv::Rect(at.x - size, at.y - size / 5, 2 * size, size * 2 / 5), color,
                      cv::FILLED);
        break;
      default:
        for (int k = -3; k <= 3; ++k) {
          cv::line(image, at + cv::Point(k * size / 4, -size), at + cv::Point(k * size / 4, size),
                   color, std::max(2, size / 12), cv::LINE_AA);
        }
    }
  }
  put_text(image, word(random, 3), {w / 12, h * 86 / 100}, 0.085 * w, bgr(p[1]),
           cv::FONT_HERSHEY_DUPLEX, 0.16);
  put_column(image, {w / 12, h * 88 / 100, w * 10 / 12, h * 8 / 100}, 0.030 * h, bgr(p[1]), random);
}

void draw_mountains(cv::Mat& image, Random& random) {
  static constexpr std::uint32_t kSky[2][2] = {{0xF4D9B0, 0x6FA3B8}, {0xF2B79A, 0x54708F}};
  static constexpr std::uint32_t kNear[2] = {0x20404A, 0x33304E};
  const int theme = random.below(2);
  const cv::Scalar low = bgr(kSky[theme][0]);
  const cv::Scalar high = bgr(kSky[theme][1]);
  const int w = image.cols;
  const int h = image.rows;
  for (int y = 0; y < h; ++y) {
    const double t = std::min(1.0, static_cast<double>(y) / (0.6 * h));
    image.row(y) = high * (1.0 - t) + low * t;
  }
  cv::circle(image, {static_cast<int>(random.uniform(0.3, 0.7) * w), h * 38 / 100}, w / 9,
             bgr(0xF9EBC8), cv::FILLED, cv::LINE_AA);
  const auto seed = static_cast<std::uint32_t>(random.next());
  for (int layer = 0; layer < 5; ++layer) {
    const double t = layer / 4.0;
    const cv::Scalar color = low * (1.0 - t) * 0.75 + bgr(kNear[theme]) * (t + 0.12);
    for (int x = 0; x < w; ++x) {
      const float s = static_cast<float>(x) / static_cast<float>(w);
      const float ridge = fractal_noise(3.0F * s + 9.0F * static_cast<float>(layer), 0.0F, 6,
                                        seed + static_cast<std::uint32_t>(layer));
      const int top = static_cast<int>(h * (0.42 + 0.12 * layer - 0.22 * ridge));
      cv::line(image, {x, std::clamp(top, 0, h - 1)}, {x, h - 1}, color);
    }
  }
  cv::rectangle(image, {0, 0, w, h}, bgr(0xF5F0E6), w / 12);
}

void draw_blocks(cv::Mat& image, Random& random) {
  const Palette& p = palette_of(random);
  image = bgr(0xF3EEE3);
  const int w = image.cols;
  const int h = image.rows;
  std::vector<int> xs = {0, w};
  std::vector<int> ys = {0, h};
  for (int i = 0; i < 4; ++i) {
    xs.push_back(static_cast<int>(random.uniform(0.08, 0.92) * w));
    ys.push_back(static_cast<int>(random.uniform(0.08, 0.92) * h));
  }
  std::sort(xs.begin(), xs.end());
  std::sort(ys.begin(), ys.end());
  for (std::size_t i = 0; i + 1 < xs.size(); ++i) {
    for (std::size_t j = 0; j + 1 < ys.size(); ++j) {
      const cv::Rect box(xs[i], ys[j], xs[i + 1] - xs[i], ys[j + 1] - ys[j]);
      if (random.below(5) < 3) {
        cv::rectangle(image, box, bgr(p[static_cast<std::size_t>(2 + random.below(3))]),
                      cv::FILLED);
      }
      cv::rectangle(image, box, bgr(0x1E1C1C), std::max(2, w / 70));
    }
  }
}

void draw_leaf(cv::Mat& image, cv::Point2d at, double angle, double length,
               const cv::Scalar& color) {
  std::vector<cv::Point> outline;
  const cv::Point2d along(std::cos(angle), std::sin(angle));
  const cv::Point2d across(-along.y, along.x);
  for (int side = 0; side < 2; ++side) {
    for (int i = 0; i <= 12; ++i) {
      const double t = (side == 0 ? i : 12 - i) / 12.0;
      const double half = (side == 0 ? 0.17 : -0.17) * length * std::sin(t * std::numbers::pi);
      outline.emplace_back(at + along * (t * length) + across * half);
    }
  }
  cv::fillPoly(image, std::vector<std::vector<cv::Point>>{outline}, color, cv::LINE_AA);
  cv::line(image, cv::Point(at), cv::Point(at + along * length), color * 0.7,
           std::max(1, static_cast<int>(0.02 * length)), cv::LINE_AA);
}

void draw_botanical(cv::Mat& image, Random& random) {
  image = bgr(0xF3EBDA);
  const int w = image.cols;
  const int h = image.rows;
  static constexpr std::uint32_t kGreens[] = {0x3E6B4F, 0x5C8A5A, 0x86A873, 0x2E5248};
  for (int stem = 0; stem < 3; ++stem) {
    const double x = w * (0.28 + 0.22 * stem);
    const double lean = random.uniform(-0.12, 0.12);
    for (int i = 0; i < 9; ++i) {
      const double t = 0.16 + 0.075 * i;
      const cv::Point2d at(x + lean * w * (1.0 - t), h * (1.0 - t));
      const double angle = (i % 2 == 0 ? -0.6 : -2.5) + random.uniform(-0.25, 0.25);
      draw_leaf(image, at, angle, w * random.uniform(0.15, 0.24), bgr(kGreens[random.below(4)]));
    }
    cv::line(image, cv::Point(static_cast<int>(x), h * 9 / 10),
             cv::Point(static_cast<int>(x + lean * w), h * 16 / 100), bgr(0x4A5B3C),
             std::max(1, w / 150), cv::LINE_AA);
  }
  put_text(image, word(random, 4), {w * 30 / 100, h * 96 / 100}, 0.04 * w, bgr(0x4A443A),
           cv::FONT_HERSHEY_COMPLEX, 0.08);
}

void draw_magazine(cv::Mat& image, Random& random, bool with_picture) {
  const Palette& p = palette_of(random);
  const int w = image.cols;
  const int h = image.rows;
  image = bgr(0xF6F2EA);
  const cv::Scalar ink = bgr(0x2A2A2C);
  int y = h / 14;
  if (with_picture) {
    put_text(image, word(random, 3), {w / 14, h / 9}, 0.075 * w, bgr(p[2]), cv::FONT_HERSHEY_DUPLEX,
             0.15);
    const cv::Rect frame(w / 14, h * 14 / 100, w * 12 / 14, h * 34 / 100);
    cv::Mat photo(frame.size(), CV_8UC3);
    draw_mountains(photo, random);
    photo.copyTo(image(frame));
    y = h / 2;
  }
  const int gap = w / 28;
  const int column = (w * 12 / 14 - 2 * gap) / 3;
  for (int i = 0; i < 3; ++i) {
    put_column(image, {w / 14 + i * (column + gap), y, column, h * 94 / 100 - y}, h / 46.0, ink,
               random);
  }
}

void draw_cover(cv::Mat& image, Random& random) {
  const Palette& p = palette_of(random);
  const int w = image.cols;
  const int h = image.rows;
  const auto ground = static_cast<std::size_t>(2 + random.below(3));
  const std::size_t other = ground == 2 ? 3 : 2;
  image = bgr(p[ground]);
  cv::rectangle(image, {w / 16, h / 16, w * 14 / 16, h * 14 / 16}, bgr(p[0]), std::max(1, w / 120));
  put_text(image, word(random, 2), {w / 9, h * 24 / 100}, 0.13 * w, bgr(p[0]));
  put_text(image, word(random, 2), {w / 9, h * 36 / 100}, 0.13 * w, bgr(p[0]));
  cv::circle(image, {w / 2, h * 62 / 100}, w / 4, bgr(p[other]), cv::FILLED, cv::LINE_AA);
  cv::circle(image, {w * 58 / 100, h * 58 / 100}, w / 7, bgr(p[1]), cv::FILLED, cv::LINE_AA);
  put_text(image, word(random, 3), {w / 9, h * 91 / 100}, 0.05 * w, bgr(p[0]));
}

void draw_map(cv::Mat& image, Random& random) {
  const auto seed = static_cast<std::uint32_t>(random.next());
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const float s = static_cast<float>(x) / static_cast<float>(image.cols);
      const float t = static_cast<float>(y) / static_cast<float>(image.cols);
      const float height = fractal_noise(3.0F * s, 3.0F * t, 5, seed);
      cv::Scalar color =
          height < -0.12F ? bgr(0x9CC4D4) : bgr(height < 0.15F ? 0xDDE3C0 : 0xD9C79B);
      const float contour = height * 26.0F - std::floor(height * 26.0F);
      if (contour < 0.10F) color = color * 0.75;
      image.at<cv::Vec3b>(y, x) =
          cv::Vec3b(static_cast<unsigned char>(color[0]), static_cast<unsigned char>(color[1]),
                    static_cast<unsigned char>(color[2]));
    }
  }
  for (int i = 0; i < 14; ++i) {
    const cv::Point at(static_cast<int>(random.uniform(0.05, 0.8) * image.cols),
                       static_cast<int>(random.uniform(0.08, 0.95) * image.rows));
    cv::circle(image, at, std::max(2, image.cols / 130), bgr(0xB03A2E), cv::FILLED, cv::LINE_AA);
    put_text(image, word(random, 2 + random.below(2)), at + cv::Point(image.cols / 80, 0),
             0.022 * image.cols, bgr(0x2B2B2B));
    const cv::Point to(static_cast<int>(random.uniform() * image.cols),
                       static_cast<int>(random.uniform() * image.rows));
    cv::line(image, at, to, bgr(0xC98B4E), std::max(1, image.cols / 300), cv::LINE_AA);
  }
  cv::rectangle(image, {0, 0, image.cols, image.rows}, bgr(0xF5F0E6), image.cols / 16);
}

}  // namespace

cv::Mat draw_print(PrintKind kind, int width_px, int height_px, std::uint64_t seed) {
  Random random(seed);
  cv::Mat image(height_px, width_px, CV_8UC3);
  switch (kind) {
    case PrintKind::kShapes:
      draw_shapes(image, random);
      break;
    case PrintKind::kMountains:
      draw_mountains(image, random);
      break;
    case PrintKind::kBlocks:
      draw_blocks(image, random);
      break;
    case PrintKind::kBotanical:
      draw_botanical(image, random);
      break;
    case PrintKind::kMagazine:
      draw_magazine(image, random, true);
      break;
    case PrintKind::kPage:
      draw_magazine(image, random, false);
      break;
    case PrintKind::kCover:
      draw_cover(image, random);
      break;
    case PrintKind::kMap:
      draw_map(image, random);
      break;
  }
  add_paper_grain(image, static_cast<std::uint32_t>(seed));
  return image;
}

cv::Mat draw_spine(int width_px, int height_px, std::uint64_t seed) {
  Random random(seed);
  const Palette& p = palette_of(random);
  const auto ground = static_cast<std::size_t>(random.below(5));
  cv::Mat lying(width_px, height_px, CV_8UC3, bgr(p[ground]));
  const cv::Scalar ink = bgr(ground == 0 ? p[1] : p[0]);
  const int band = height_px / 12;
  cv::rectangle(lying, {band, 0, band / 3, width_px}, ink, cv::FILLED);
  cv::rectangle(lying, {height_px - 2 * band, 0, band / 3, width_px}, ink, cv::FILLED);
  put_text(lying, word(random, 2 + random.below(3)), {2 * band, width_px * 66 / 100},
           0.42 * width_px, ink);
  cv::Mat upright;
  cv::rotate(lying, upright, cv::ROTATE_90_CLOCKWISE);
  return upright;
}

cv::Mat draw_window(int width_px, int height_px, int columns, int rows, std::uint64_t seed) {
  cv::Mat image(height_px, width_px, CV_8UC3);
  const auto noise_seed = static_cast<std::uint32_t>(seed);
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      const float s = static_cast<float>(x) / static_cast<float>(width_px);
      const float t = static_cast<float>(y) / static_cast<float>(height_px);
      const float trees = 0.62F + 0.35F * fractal_noise(3.5F * s, 3.5F * t, 3, noise_seed);
      const float leaf = 0.5F + 0.5F * fractal_noise(14.0F * s, 14.0F * t, 3, noise_seed + 1);
      const float cloud = 0.5F + fractal_noise(3.0F * s, 7.0F * t, 4, noise_seed + 2);
      const cv::Scalar sky = bgr(0xBFD9EE) * (1.0 - cloud) + bgr(0xFFFFFF) * cloud;
      const cv::Scalar green = bgr(0x7FA565) * leaf + bgr(0xD7E3A8) * (1.0 - leaf);
      const double share = std::clamp((t - trees) * 9.0F, 0.0F, 1.0F);
      const cv::Scalar color = sky * (1.0 - share) + green * share;
      image.at<cv::Vec3b>(y, x) = cv::Vec3b(cv::saturate_cast<unsigned char>(color[0]),
                                            cv::saturate_cast<unsigned char>(color[1]),
                                            cv::saturate_cast<unsigned char>(color[2]));
    }
  }
  cv::GaussianBlur(image, image, {}, width_px / 90.0);
  const int bar = std::max(3, width_px / 22);
  const cv::Scalar white = bgr(0xD8D4CC);
  cv::rectangle(image, {0, 0, width_px, height_px}, white, 2 * bar);
  for (int i = 1; i < columns; ++i) {
    const int x = width_px * i / columns;
    cv::rectangle(image, {x - bar / 2, 0, bar, height_px}, white, cv::FILLED);
  }
  for (int j = 1; j < rows; ++j) {
    const int y = height_px * j / rows;
    cv::rectangle(image, {0, y - bar / 2, width_px, bar}, white, cv::FILLED);
  }
  cv::rectangle(image, {bar, bar, width_px - 2 * bar, height_px - 2 * bar}, bgr(0x9D9A94), 1);
  return image;
}

}  // namespace planecast::engine::synth
