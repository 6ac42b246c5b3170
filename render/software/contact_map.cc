#include "render/software/contact_map.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace planecast::render {

constexpr int kPattern = 4;  ///< texels along a side of the pattern of directions and distances
constexpr int kDirections = 8;
constexpr int kSteps = 6;

/// Where the texels of one place of the pattern look: texels away, and the squared distance.
struct ContactLook {
  int x = 0;
  int y = 0;
  float distance2 = 0.0F;
};

// Compiled for several instruction sets: a name that others see.
void keep_larger(const float* tops, const float* undersides, float distance2, int count,
                 float* hidden);

/// The share H^2 / (H^2 + r^2) - h^2 / (h^2 + r^2) of contact.frag, on squared heights.
PLANECAST_WIDE void keep_larger(const float* __restrict tops, const float* __restrict undersides,
                                float distance2, int count, float* __restrict hidden) {
  for (int i = 0; i < count; ++i) {
    const float top = tops[i];
    const float underside = undersides[i];
    const float share =
        distance2 * (top - underside) / ((top + distance2) * (underside + distance2));
    hidden[i] = larger(hidden[i], share);
  }
}

namespace {

constexpr F4 kNothingThere = {-1e9F, -1e9F, -1e9F, -1e9F};

/// As the order of contact.frag: neighbours differ most.
std::array<ContactLook, kSteps> looks(int cell_x, int cell_y, int direction, float reach_m,
                                      const glm::vec2& texels_per_m) {
  const auto x = static_cast<unsigned>(cell_x);
  const auto y = static_cast<unsigned>(cell_y);
  const unsigned bits = x ^ y;
  const unsigned order = ((bits & 1U) << 3U) | ((y & 1U) << 2U) | (bits & 2U) | (y >> 1U);
  const float turn = (static_cast<float>(order) + 0.5F) / 16.0F;
  const float jitter = turn * 9.7F - std::floor(turn * 9.7F);
  const float angle = 6.2831853F * (static_cast<float>(direction) + turn) / kDirections;
  std::array<ContactLook, kSteps> result;
  for (std::size_t s = 0; s < kSteps; ++s) {
    const float share = (static_cast<float>(s) + jitter) / kSteps;
    const float r = reach_m * share * share + 1e-6F;
    const glm::vec2 away = glm::vec2(std::cos(angle), std::sin(angle)) * r * texels_per_m;
    result[s] = {static_cast<int>(std::floor(0.5F + away.x)),
                 static_cast<int>(std::floor(0.5F + away.y)), r * r};
  }
  return result;
}

float smooth_step(float from, float to, float x) {
  const float t = std::clamp((x - from) / (to - from), 0.0F, 1.0F);
  return t * t * (3.0F - 2.0F * t);
}

/// Contact shadows end softly at the border of what is looked at.
std::vector<float> border_shares(int side) {
  std::vector<float> shares(static_cast<std::size_t>(side));
  for (int i = 0; i < side; ++i) {
    shares[static_cast<std::size_t>(i)] = (static_cast<float>(i) + 0.5F) / static_cast<float>(side);
  }
  for (float& share : shares) share = std::min(share, 1.0F - share);
  return shares;
}

}  // namespace

void ContactMap::make(const CatcherPlan& plan, const std::vector<DrawItem>& items,
                      const PosedMeshes& meshes, float detail_texels) {
  side_ = plan.contact_side;
  const glm::vec2 texels_per_m = static_cast<float>(side_) / plan.contact_region.size();
  const float reach = plan.contact_reach_m * std::max(texels_per_m.x, texels_per_m.y);
  margin_ = kPattern * (static_cast<int>(reach) / kPattern + 2);
  hidden_ = ImageF(side_, side_, 1);
  draw_heights(plan, items, meshes, detail_texels / texels_per_m.x);
  split_heights();
  find_hidden(plan);
}

void ContactMap::draw_heights(const CatcherPlan& plan, const std::vector<DrawItem>& items,
                              const PosedMeshes& meshes, float error_m) {
  const auto blocks = static_cast<std::size_t>(side_ / 4) * static_cast<std::size_t>(side_);
  tops_.assign(blocks, kNothingThere);
  undersides_.assign(blocks, kNothingThere);
  const glm::vec2 scale = static_cast<float>(side_) / plan.contact_region.size();
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (items[i].mode != GL_TRIANGLES) continue;
    const std::vector<WorldVertex>& vertices = meshes[i].vertices;
    screen_.resize(vertices.size());
    for (std::size_t v = 0; v < vertices.size(); ++v) {
      const glm::vec3& p = vertices[v].position;
      const glm::vec2 at = (plan.frame.coordinates(p) - plan.contact_region.min) * scale - 0.5F;
      screen_[v] = snapped(at.x, at.y, plan.frame.height(p), 1.0F);
    }
    const auto& indices = triangles_of(items[i], error_m);
    for (std::size_t k = 0; k + 2 < indices.size(); k += 3) {
      draw_triangle(screen_[indices[k]], screen_[indices[k + 1]], screen_[indices[k + 2]]);
    }
  }
}

void ContactMap::draw_triangle(const ScreenVertex& a, const ScreenVertex& b,
                               const ScreenVertex& c) {
  const DepthSlopes slopes = depth_slopes(a, b, c);
  if (!slopes.any) return;
  const SamplePattern pattern = SamplePattern::pixel_centres();
  const LinearValue height_at(pattern, a, a.depth, slopes.x, slopes.y);
  const int columns = side_ / 4;
  visit_covered({a, b, c}, pattern, columns, side_, [&](int x, int y, const I4& covered) {
    const auto at = static_cast<std::size_t>(y * columns + x);
    const F4 height = height_at.at(x, y);
    const F4 sunk = -(height > 0.0F ? height : F4{});
    tops_[at] = (covered & (height > tops_[at])) ? height : tops_[at];
    undersides_[at] = (covered & (sunk > undersides_[at])) ? sunk : undersides_[at];
  });
}

/// A row holds its texels 0, 4, 8.., then 1, 5, 9.. and so on, each with a margin at both ends.
std::size_t ContactMap::split_place(int x, int y) const {
  const int group = (side_ + 2 * margin_) / kPattern;
  const int column = x + margin_;
  return static_cast<std::size_t>(((y + margin_) * kPattern + column % kPattern) * group +
                                  column / kPattern);
}

void ContactMap::split_heights() {
  const auto padded = static_cast<std::size_t>(side_ + 2 * margin_);
  split_tops_.assign(padded * padded, 0.0F);
  split_undersides_.assign(padded * padded, 0.0F);
  for (int y = 0; y < side_; ++y) {
    for (int x = 0; x < side_; ++x) {
      const auto block = static_cast<std::size_t>(y * (side_ / 4) + x / 4);
      const float top = std::max(tops_[block][x % 4], 0.0F);
      const float underside = std::min(std::max(-undersides_[block][x % 4], 0.0F), top);
      split_tops_[split_place(x, y)] = top * top;
      split_undersides_[split_place(x, y)] = underside * underside;
    }
  }
}

void ContactMap::find_hidden(const CatcherPlan& plan) {
  const glm::vec2 texels_per_m = static_cast<float>(side_) / plan.contact_region.size();
  const int count = side_ / kPattern;
  std::vector<float> sum(static_cast<std::size_t>(count));
  std::vector<float> farthest(sum.size());
  ImageF sharp(side_, side_, 1);
  const std::vector<float> border = border_shares(side_);
  for (int cell = 0; cell < kPattern * kPattern; ++cell) {
    const int cell_x = cell % kPattern;
    const int cell_y = cell / kPattern;
    std::array<std::array<ContactLook, kSteps>, kDirections> all;
    for (int d = 0; d < kDirections; ++d) {
      all[static_cast<std::size_t>(d)] =
          looks(cell_x, cell_y, d, plan.contact_reach_m, texels_per_m);
    }
    for (int y = cell_y; y < side_; y += kPattern) {
      std::ranges::fill(sum, 0.0F);
      for (const auto& direction : all) {
        std::ranges::fill(farthest, 0.0F);
        for (const ContactLook& look : direction) {
          const std::size_t at = split_place(cell_x + look.x, y + look.y);
          keep_larger(&split_tops_[at], &split_undersides_[at], look.distance2, count,
                      farthest.data());
        }
        std::ranges::transform(sum, farthest, sum.begin(), std::plus<>());
      }
      for (int i = 0; i < count; ++i) {
        const int x = cell_x + kPattern * i;
        const float to_border =
            std::min(border[static_cast<std::size_t>(x)], border[static_cast<std::size_t>(y)]);
        sharp.pixels[static_cast<std::size_t>(y * side_ + x)] =
            smooth_step(0.0F, 0.2F, to_border) * sum[static_cast<std::size_t>(i)] / kDirections;
      }
    }
  }
  blur(sharp);
}

/// The mean over the pattern, first along the rows, then down.
void ContactMap::blur(const ImageF& sharp) {
  const auto at = [&](const ImageF& image, int x, int y) {
    const int last = side_ - 1;
    return image
        .pixels[static_cast<std::size_t>(std::clamp(y, 0, last) * side_ + std::clamp(x, 0, last))];
  };
  ImageF along(side_, side_, 1);
  for (int y = 0; y < side_; ++y) {
    for (int x = 0; x < side_; ++x) {
      float sum = 0.0F;
      for (int k = -2; k < 2; ++k) sum += at(sharp, x + k, y);
      along.pixels[static_cast<std::size_t>(y * side_ + x)] = sum;
    }
  }
  for (int y = 0; y < side_; ++y) {
    for (int x = 0; x < side_; ++x) {
      float sum = 0.0F;
      for (int k = -2; k < 2; ++k) sum += at(along, x, y + k);
      hidden_.pixels[static_cast<std::size_t>(y * side_ + x)] = sum / (kPattern * kPattern);
    }
  }
}

}  // namespace planecast::render
