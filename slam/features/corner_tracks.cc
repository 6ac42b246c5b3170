#include "slam/features/corner_tracks.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>
#include <utility>

#include "slam/features/pyramid.h"

namespace planecast::slam {

void CornerTracks::start(const ImagePyramid& reference, const Features& features) {
  tracks_.clear();
  looks_.clear();
  std::vector<int> order(features.keypoints.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return features.keypoints[static_cast<std::size_t>(a)].response >
           features.keypoints[static_cast<std::size_t>(b)].response;
  });
  const int last = static_cast<int>(reference.levels.size()) - 1;
  for (const int k : order) {
    if (static_cast<int>(tracks_.size()) == options_.max_tracks) break;
    const Keypoint& keypoint = features.keypoints[static_cast<std::size_t>(k)];
    const int own = std::min(
        last,
        static_cast<int>(std::lround(std::log2(options_.scale_levels.scale(keypoint.octave)))));
    std::vector<Looks> looks;
    for (int level = std::min(last, own + options_.levels - 1); level >= own; --level) {
      const auto patch = make_template(reference.levels[static_cast<std::size_t>(level)],
                                       at_level(keypoint.raw, level), Eigen::Matrix2f::Identity());
      if (patch) looks.push_back({level, *patch});
    }
    if (looks.empty() || looks.back().level != own) continue;
    tracks_.push_back({k, keypoint.raw, 1.0F});
    looks_.push_back(std::move(looks));
  }
  started_ = static_cast<int>(tracks_.size());
}

bool CornerTracks::follow(const ImagePyramid& image, const std::vector<Looks>& looks,
                          CornerTrack& track) const {
  PatchAlignOptions align;
  align.max_shift_px = options_.max_shift_px;
  Eigen::Vector2f raw = track.raw;
  for (const Looks& at : looks) {
    const auto found = align_patch(at.patch, image.levels[static_cast<std::size_t>(at.level)],
                                   at_level(raw, at.level), align);
    const bool finest = &at == &looks.back();
    // What a coarse level does not find, the next may.
    if (found && (finest || found->correlation > 0.5F)) raw = from_level(found->pixel, at.level);
    if (!finest) continue;
    if (!found || found->correlation < static_cast<float>(options_.min_correlation)) return false;
    track.correlation = found->correlation;
  }
  track.raw = raw;
  return true;
}

void CornerTracks::follow(const ImagePyramid& image) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (!follow(image, looks_[i], tracks_[i])) continue;
    if (kept != i) {
      tracks_[kept] = tracks_[i];
      looks_[kept] = std::move(looks_[i]);
    }
    ++kept;
  }
  tracks_.resize(kept);
  looks_.resize(kept);
}

}  // namespace planecast::slam
