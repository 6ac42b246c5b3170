#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "engine/sequence/synth/textures.h"

namespace planecast::engine::synth {

/// A square picture that repeats, mirrored, with its halved copies.
class TilePyramid {
 public:
  /// `tile` is CV_32FC3, linear RGB, a power of two wide and high.
  explicit TilePyramid(const cv::Mat& tile);
  /// (u, v) in repeats, `footprint` the width of what is averaged, in repeats too.
  Color at(float u, float v, float footprint) const;

 private:
  std::vector<cv::Mat> levels_;
};

enum class TileKind {
  kWall,    ///< plaster, wallpaper, bricks, concrete
  kFloor,   ///< boards, tiles, carpet
  kWood,    ///< furniture
  kCloth,   ///< fabrics, also printed ones
  kPrint,   ///< posters, pages, screens
  kObject,  ///< blotches, plastic, leaves
};
inline constexpr int kTileKinds = 6;

/// Pictures for the surfaces of training rooms, made when first asked for; a function of the seed.
class TileBank {
 public:
  explicit TileBank(std::uint64_t seed, int per_kind = 48) : seed_(seed), per_kind_(per_kind) {
    tiles_.resize(static_cast<std::size_t>(per_kind * kTileKinds));
  }
  int per_kind() const { return per_kind_; }
  const TilePyramid& tile(TileKind kind, int index);

 private:
  std::uint64_t seed_;
  int per_kind_;
  std::vector<std::unique_ptr<TilePyramid>> tiles_;
};

}  // namespace planecast::engine::synth
