#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "slam/geometry/raw_rays.h"
#include "slam/segmentation/depth_blocks.h"
#include "slam/segmentation/plane_segmenter.h"

namespace planecast::slam {

namespace {

struct DepthPlaneOptions {
  int blocks_per_row = 80;      ///< normals are taken at an eighth of 640 px
  double min_filled = 0.6;      ///< share of a block's pixels that must have depth
  double max_seed_chi2 = 2.0;   ///< mean squared residual over the expected, of a 3x3 seed
  double max_block_chi2 = 6.0;  ///< of a block against the region it joins
  double max_merge_chi2 = 5.0;  ///< of each of two touching regions against their common plane
  double pixel_sigmas = 4.0;    ///< of a pixel that takes a label
  double min_share = 0.006;     ///< smallest region, share of the image's blocks
};

struct Region {
  std::vector<int> blocks;
  InverseDepthSums sums;
  Eigen::Vector3d theta;
};

/// Grows regions of blocks whose pixels lie on one plane, best seeds first.
class RegionGrower {
 public:
  RegionGrower(const DepthBlocks& blocks, const DepthPlaneOptions& options)
      : blocks_(blocks), options_(options), region_of_(blocks.sums.size(), kFree) {
    const double pixels = blocks.size_px * blocks.size_px;
    for (std::size_t i = 0; i < blocks.sums.size(); ++i) {
      if (blocks.sums[i].count < options.min_filled * pixels) region_of_[i] = kUnusable;
    }
  }

  std::vector<Region> grow_all() {
    std::vector<Region> regions;
    const int min_blocks =
        std::max(6, static_cast<int>(std::lround(options_.min_share * blocks_.count())));
    for (const auto& [chi2, seed] : seeds()) {
      Region region;
      if (!start(seed, region)) continue;
      grow(region);
      // The plane has moved since the first blocks joined: once more from what it became.
      regrow(region);
      if (static_cast<int>(region.blocks.size()) < min_blocks) {
        release(region);
        continue;
      }
      regions.push_back(std::move(region));
    }
    merge_touching(regions);
    std::stable_sort(regions.begin(), regions.end(), [](const Region& a, const Region& b) {
      return a.blocks.size() > b.blocks.size();
    });
    return regions;
  }

 private:
  static constexpr int kFree = 0;
  static constexpr int kTaken = 1;
  static constexpr int kUnusable = -1;

  template <typename Visit>
  void visit_square(int block, Visit visit) const {
    const int x = block % blocks_.cols;
    const int y = block / blocks_.cols;
    for (int v = y - 1; v <= y + 1; ++v) {
      for (int u = x - 1; u <= x + 1; ++u) {
        if (u >= 0 && v >= 0 && u < blocks_.cols && v < blocks_.rows) visit(v * blocks_.cols + u);
      }
    }
  }

  bool sum_square(int block, InverseDepthSums& sums) const {
    int free = 0;
    visit_square(block, [&](int other) {
      if (region_of_[other] != kFree) return;
      sums += blocks_.sums[other];
      ++free;
    });
    return free == 9;
  }

  /// (chi2, block) of every 3x3 square of blocks that lies on a plane, flattest first.
  std::vector<std::pair<double, int>> seeds() const {
    std::vector<std::pair<double, int>> result;
    for (int i = 0; i < blocks_.count(); ++i) {
      InverseDepthSums sums;
      if (!sum_square(i, sums)) continue;
      const double chi2 = sums.chi2(sums.solve());
      if (chi2 < options_.max_seed_chi2) result.emplace_back(chi2, i);
    }
    std::sort(result.begin(), result.end());
    return result;
  }

  bool start(int seed, Region& region) {
    if (!sum_square(seed, region.sums)) return false;
    region.theta = region.sums.solve();
    visit_square(seed, [&](int block) { take(block, region); });
    return true;
  }

  void take(int block, Region& region) {
    region_of_[block] = kTaken;
    region.blocks.push_back(block);
  }

  void release(const Region& region) {
    for (const int block : region.blocks) region_of_[block] = kFree;
  }

  /// Breadth first over the four neighbours; the plane follows what joins.
  void grow(Region& region) {
    for (std::size_t head = 0; head < region.blocks.size(); ++head) {
      const int block = region.blocks[head];
      const int x = block % blocks_.cols;
      if (x > 0) try_join(block - 1, region);
      if (x + 1 < blocks_.cols) try_join(block + 1, region);
      if (block >= blocks_.cols) try_join(block - blocks_.cols, region);
      if (block + blocks_.cols < blocks_.count()) try_join(block + blocks_.cols, region);
    }
  }

  void try_join(int block, Region& region) {
    if (region_of_[block] != kFree) return;
    if (blocks_.sums[block].chi2(region.theta) > options_.max_block_chi2) return;
    take(block, region);
    region.sums += blocks_.sums[block];
    region.theta = region.sums.solve();
  }

  void regrow(Region& region) {
    Region again;
    for (const int block : region.blocks) {
      region_of_[block] = kFree;
      if (blocks_.sums[block].chi2(region.theta) > options_.max_block_chi2) continue;
      again.blocks.push_back(block);
      again.sums += blocks_.sums[block];
    }
    for (const int block : again.blocks) region_of_[block] = kTaken;
    again.theta = again.blocks.empty() ? region.theta : again.sums.solve();
    region = std::move(again);
    grow(region);
  }

  /// The sensor bends large planes by more than its noise, which cuts them up; what fits together
  /// is joined.
  void merge_touching(std::vector<Region>& regions) const {
    for (std::size_t i = 0; i < regions.size(); ++i) {
      for (std::size_t j = i + 1; j < regions.size();) {
        InverseDepthSums sums = regions[i].sums;
        sums += regions[j].sums;
        const Eigen::Vector3d theta = sums.solve();
        const bool fits = regions[i].sums.chi2(theta) < options_.max_merge_chi2 &&
                          regions[j].sums.chi2(theta) < options_.max_merge_chi2;
        if (!fits || !touch(regions[i], regions[j])) {
          ++j;
          continue;
        }
        regions[i].sums = sums;
        regions[i].theta = theta;
        regions[i].blocks.insert(regions[i].blocks.end(), regions[j].blocks.begin(),
                                 regions[j].blocks.end());
        regions.erase(regions.begin() + static_cast<std::ptrdiff_t>(j));
        j = i + 1;
      }
    }
  }

  bool touch(const Region& a, const Region& b) const {
    std::vector<char> near(region_of_.size(), 0);
    for (const int block : a.blocks) visit_square(block, [&](int other) { near[other] = 1; });
    return std::any_of(b.blocks.begin(), b.blocks.end(),
                       [&](int block) { return near[block] != 0; });
  }

  const DepthBlocks& blocks_;
  const DepthPlaneOptions& options_;
  std::vector<int> region_of_;
};

/// Labels the pixels of a region's blocks and of those around them that lie on its plane; where
/// regions compete, the smaller residual wins.
class PixelLabeller {
 public:
  PixelLabeller(const cv::Mat& depth, const cv::Mat& rays, const DepthBlocks& blocks,
                double max_sigmas)
      : depth_(depth),
        rays_(rays),
        blocks_(blocks),
        labels_(cv::Mat::zeros(depth.size(), CV_16U)),
        sigmas_(depth.size(), CV_32F, cv::Scalar(max_sigmas)) {}

  void paint(const Region& region, int label) {
    std::vector<char> near(blocks_.sums.size(), 0);
    for (const int block : region.blocks) mark_around(block, near);
    for (int block = 0; block < blocks_.count(); ++block) {
      if (near[block]) paint_block(block, region.theta, label);
    }
  }
  const cv::Mat& labels() const { return labels_; }

 private:
  void mark_around(int block, std::vector<char>& near) const {
    const int x = block % blocks_.cols;
    const int y = block / blocks_.cols;
    for (int v = std::max(y - 1, 0); v <= std::min(y + 1, blocks_.rows - 1); ++v) {
      for (int u = std::max(x - 1, 0); u <= std::min(x + 1, blocks_.cols - 1); ++u) {
        near[v * blocks_.cols + u] = 1;
      }
    }
  }

  void paint_block(int block, const Eigen::Vector3d& theta, int label) {
    const int size = blocks_.size_px;
    const cv::Rect area =
        cv::Rect(block % blocks_.cols * size, block / blocks_.cols * size, size, size) &
        cv::Rect(0, 0, depth_.cols, depth_.rows);
    for (int y = area.y; y < area.br().y; ++y) {
      const float* z = depth_.ptr<float>(y);
      const cv::Vec2f* ray = rays_.ptr<cv::Vec2f>(y);
      float* best = sigmas_.ptr<float>(y);
      ushort* out = labels_.ptr<ushort>(y);
      for (int x = area.x; x < area.br().x; ++x) {
        if (!(z[x] > 0.0F)) continue;
        const double residual =
            1.0 / z[x] - (theta.x() * ray[x][0] + theta.y() * ray[x][1] + theta.z());
        const float sigmas = static_cast<float>(std::abs(residual) / inverse_depth_sigma(z[x]));
        if (sigmas >= best[x]) continue;
        best[x] = sigmas;
        out[x] = static_cast<ushort>(label);
      }
    }
  }

  const cv::Mat& depth_;
  const cv::Mat& rays_;
  const DepthBlocks& blocks_;
  cv::Mat labels_;
  cv::Mat sigmas_;
};

class DepthSegmenter : public PlaneSegmenter {
 public:
  explicit DepthSegmenter(const Camera& camera) : camera_(camera) {}

  cv::Mat segment(const FrameInput& frame) override {
    if (frame.depth.empty() || frame.depth.type() != CV_32F) return {};
    if (rays_.size() != frame.depth.size()) {
      rays_ = raw_rays(camera_.scaled_to(frame.depth.cols, frame.depth.rows));
    }
    const int size_px = std::max(3, frame.depth.cols / options_.blocks_per_row);
    const DepthBlocks blocks = sum_blocks(frame.depth, rays_, size_px);
    const std::vector<Region> regions = RegionGrower(blocks, options_).grow_all();
    PixelLabeller labeller(frame.depth, rays_, blocks, options_.pixel_sigmas);
    for (std::size_t i = 0; i < regions.size(); ++i) {
      labeller.paint(regions[i], static_cast<int>(i) + 1);
    }
    return labeller.labels();
  }
  std::string name() const override { return "depth 1"; }

 private:
  Camera camera_;
  DepthPlaneOptions options_;
  cv::Mat rays_;
};

}  // namespace

std::unique_ptr<PlaneSegmenter> make_depth_segmenter(const Camera& camera) {
  return std::make_unique<DepthSegmenter>(camera);
}

}  // namespace planecast::slam
