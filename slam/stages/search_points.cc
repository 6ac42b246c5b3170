#include "slam/stages/search_points.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "slam/features/pyramid.h"
#include "slam/features/warp_patch.h"
#include "slam/geometry/change_of_view.h"
#include "slam/geometry/lens.h"
#include "slam/segmentation/plane_segmenter.h"
#include "slam/stages/prepare_image.h"

namespace planecast::slam {
namespace {

/// Steps along an epipolar line, in pixels of the level: a patch's correlation falls over about
/// two.
constexpr double kStepPx = 1.5;
/// Correlations so near to the best place, in steps, belong to the same peak.
constexpr int kPeakSteps = 3;
/// How far alignment may lead from the best step, in pixels of the level.
constexpr float kMaxSettlePx = 2.0F;
/// Where alignment ends at a level that only leads to a finer one.
constexpr float kCoarseConvergedPx = 0.25F;

struct InverseDepths {
  double least = 0.0;
  double median = 0.0;
  double most = 0.0;
};

std::optional<InverseDepths> depth_range(const Map& map, const Keyframe& keyframe,
                                         const SearchPointsOptions& options) {
  std::vector<double> depths = map.landmark_depths(keyframe.id);
  std::erase_if(depths, [](double z) { return !(z > 0.0); });
  if (depths.size() < 10) return std::nullopt;
  const auto ranked = [&depths](std::size_t rank) {
    const auto place = depths.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(depths.begin(), place, depths.end());
    return *place;
  };
  const std::size_t tail = depths.size() / 20;
  return InverseDepths{1.0 / (options.farthest_depth * ranked(depths.size() - 1 - tail)),
                       1.0 / ranked(depths.size() / 2),
                       1.0 / (options.nearest_depth * ranked(tail))};
}

/// Keypoints without a landmark that are worth another look, strongest first.
std::vector<int> free_keypoints(const Keyframe& keyframe, const std::vector<std::uint8_t>& searched,
                                const SearchPointsOptions& options) {
  std::vector<int> keypoints;
  for (int k = 0; k < keyframe.features->size(); ++k) {
    const auto at = static_cast<std::size_t>(k);
    if (keyframe.landmarks[at] == kNone && searched[at] < options.max_searches) {
      keypoints.push_back(k);
    }
  }
  std::stable_sort(keypoints.begin(), keypoints.end(), [&](int a, int b) {
    return keyframe.features->keypoints[static_cast<std::size_t>(a)].response >
           keyframe.features->keypoints[static_cast<std::size_t>(b)].response;
  });
  const auto most = static_cast<std::size_t>(options.max_points);
  if (keypoints.size() > most) keypoints.resize(most);
  return keypoints;
}

/// The search of one neighbour's keypoints in the new keyframe.
class EpipolarSearch {
 public:
  EpipolarSearch(const Camera& camera, const Keyframe& neighbour, const Keyframe& keyframe,
                 const InverseDepths& range, const SearchPointsOptions& options)
      : camera_(camera),
        neighbour_(neighbour),
        keyframe_(keyframe),
        range_(range),
        options_(options),
        cam_from_neighbour_(keyframe.cam_from_world * neighbour.cam_from_world.inverse()) {}

  std::optional<Sighting> find(int k) {
    const Keypoint& keypoint = neighbour_.features->keypoints[static_cast<std::size_t>(k)];
    const Eigen::Vector3d ray = camera_.ray(keypoint.pixel.cast<double>());
    std::optional<Line> line = line_of(ray);
    if (!line) return std::nullopt;
    const double reach = kStepPx * options_.max_steps *
                         options_.points.levels.scale(keypoint.octave) *
                         (1 << options_.coarser_levels);
    line->shorten(reach);
    if (!meets_image(*line)) return std::nullopt;
    const auto view =
        change_of_view(camera_, ray / range_.median, Eigen::Vector3d::UnitZ(), cam_from_neighbour_);
    if (!view) return std::nullopt;
    // A long line is searched at a coarser level, and the place then followed to the finer ones.
    std::optional<Eigen::Vector2f> raw;
    for (int coarser = coarser_levels(*line, keypoint); coarser >= 0; --coarser) {
      const auto samples = warp_samples(*neighbour_.pyramid, keypoint, *view, *keyframe_.pyramid,
                                        options_.points.levels, coarser);
      if (!samples) return std::nullopt;
      if (!raw) raw = search(*line, *samples);
      if (!raw) return std::nullopt;
      const auto patch = make_template(samples->looks);
      if (!patch) return std::nullopt;
      PatchAlignOptions align;
      align.max_shift_px = kMaxSettlePx;
      if (coarser > 0) align.converged_px = kCoarseConvergedPx;
      const int level = samples->level;
      const auto settled = align_patch(*patch, image_at(level), at_level(*raw, level), align);
      if (!settled || settled->correlation < options_.min_correlation) return std::nullopt;
      raw = from_level(settled->pixel, level);
    }
    return sighting(k, keypoint, *raw);
  }

 private:
  const cv::Mat& image_at(int level) const {
    return keyframe_.pyramid->levels[static_cast<std::size_t>(level)];
  }

  /// Undistorted pixels between which a keypoint's point lies in the new keyframe.
  struct Line {
    Eigen::Vector2d begin;   ///< of the farthest depth
    Eigen::Vector2d middle;  ///< of the median depth
    Eigen::Vector2d end;     ///< of the nearest
    double length() const { return (end - begin).norm(); }
    /// Cuts off what is farther than half of `longest` from the middle.
    void shorten(double longest) {
      if (length() <= longest) return;
      const Eigen::Vector2d along = (end - begin).normalized();
      const double before = std::min((middle - begin).norm(), longest / 2.0);
      const double after = std::min((end - middle).norm(), longest / 2.0);
      begin = middle - before * along;
      end = middle + after * along;
    }
  };

  std::optional<Line> line_of(const Eigen::Vector3d& ray) const {
    const Eigen::Vector3d turned = cam_from_neighbour_.linear() * ray;
    const Eigen::Vector3d& shift = cam_from_neighbour_.translation();
    const Eigen::Vector3d far_point = turned + range_.least * shift;
    const Eigen::Vector3d middle = turned + range_.median * shift;
    Eigen::Vector3d near_point = turned + range_.most * shift;
    constexpr double kMinZ = 0.05;  // of the ray's length: in front of the camera
    if (!(far_point.z() > kMinZ && middle.z() > kMinZ)) return std::nullopt;
    if (near_point.z() < kMinZ) near_point = turned + (kMinZ - turned.z()) / shift.z() * shift;
    return Line{camera_.project(far_point), camera_.project(middle), camera_.project(near_point)};
  }

  /// Whether one of its ends or its middle is in the image.
  bool meets_image(const Line& line) const {
    return camera_.contains(line.middle) || camera_.contains(line.begin) ||
           camera_.contains(line.end);
  }

  /// Levels above the keypoint's own at which the line is short enough.
  int coarser_levels(const Line& line, const Keypoint& keypoint) const {
    double steps = line.length() / (kStepPx * options_.points.levels.scale(keypoint.octave));
    int coarser = 0;
    for (; coarser < options_.coarser_levels && steps > options_.max_steps; ++coarser) steps /= 2.0;
    return coarser;
  }

  /// Raw pixel of the best correlation along the line.
  std::optional<Eigen::Vector2f> search(const Line& line, const WarpedSamples& patch) {
    const double length = line.length() / (1 << patch.level);
    const int steps = static_cast<int>(std::ceil(length / kStepPx)) + 1;
    const QuickTemplate quick(patch.looks);
    places_.clear();
    scores_.clear();
    for (int s = 0; s <= steps; ++s) {
      const Eigen::Vector2d pixel =
          line.begin + (line.end - line.begin) * (static_cast<double>(s) / steps);
      if (!camera_.contains(pixel)) continue;
      const Eigen::Vector2d raw = camera_.has_distortion() ? camera_.distort(pixel) : pixel;
      places_.push_back(raw.cast<float>());
      scores_.push_back(
          quick.correlate(image_at(patch.level), at_level(places_.back(), patch.level)));
    }
    return unambiguous_best();
  }

  std::optional<Eigen::Vector2f> unambiguous_best() const {
    if (scores_.empty()) return std::nullopt;
    const auto best = std::max_element(scores_.begin(), scores_.end());
    // Up to half a pixel and half a step beside the place, the correlation is less than settled.
    constexpr double kBesideShare = 0.75;
    if (*best < kBesideShare * options_.min_correlation) return std::nullopt;
    const auto at = best - scores_.begin();
    for (std::ptrdiff_t s = 0; s < static_cast<std::ptrdiff_t>(scores_.size()); ++s) {
      if (std::abs(s - at) > kPeakSteps &&
          scores_[static_cast<std::size_t>(s)] >
              options_.max_runner_up * static_cast<double>(*best)) {
        return std::nullopt;
      }
    }
    return places_[static_cast<std::size_t>(at)];
  }

  std::optional<Sighting> sighting(int k, const Keypoint& keypoint,
                                   const Eigen::Vector2f& raw) const {
    Keypoint seen = keypoint;
    seen.raw = raw;
    seen.pixel = camera_.undistort(raw.cast<double>()).cast<float>();
    const auto position =
        point_from_two(camera_, keyframe_, seen, neighbour_, keypoint, options_.points);
    if (!position) return std::nullopt;
    Sighting result;
    result.seen = {{neighbour_.id, k}};
    result.point.raw = seen.raw;
    result.point.pixel = seen.pixel.cast<double>();
    result.point.octave = keypoint.octave;
    result.position = *position;
    return result;
  }

  const Camera& camera_;
  const Keyframe& neighbour_;
  const Keyframe& keyframe_;
  const InverseDepths& range_;
  const SearchPointsOptions& options_;
  Pose cam_from_neighbour_;
  std::vector<Eigen::Vector2f> places_;
  std::vector<float> scores_;
};

/// Sightings by their place; one at the place of an earlier one, of another neighbour, is the same
/// point.
class Sightings {
 public:
  explicit Sightings(const Camera& camera)
      : columns_(camera.width / kCellPx + 1),
        rows_(camera.height / kCellPx + 1),
        cells_(static_cast<std::size_t>(columns_ * rows_)) {}

  void add(Sighting sighting) {
    constexpr float kSamePx = 1.0F;
    const KeyframeId neighbour = sighting.seen.front().keyframe;
    const int column = cell(sighting.point.raw.x(), columns_);
    const int row = cell(sighting.point.raw.y(), rows_);
    int same = kNone;
    for (int r = std::max(0, row - 1); r <= std::min(rows_ - 1, row + 1); ++r) {
      for (int c = std::max(0, column - 1); c <= std::min(columns_ - 1, column + 1); ++c) {
        for (const int earlier : cells_[static_cast<std::size_t>(r * columns_ + c)]) {
          const Eigen::Vector2f& raw = found_[static_cast<std::size_t>(earlier)].point.raw;
          const bool here = (raw - sighting.point.raw).squaredNorm() <= kSamePx * kSamePx;
          if (here && (same == kNone || earlier < same)) same = earlier;
        }
      }
    }
    if (same != kNone) {
      std::vector<Observation>& seen = found_[static_cast<std::size_t>(same)].seen;
      const bool other = std::none_of(seen.begin(), seen.end(), [&](const Observation& one) {
        return one.keyframe == neighbour;
      });
      if (other) seen.push_back(sighting.seen.front());
      return;
    }
    cells_[static_cast<std::size_t>(row * columns_ + column)].push_back(
        static_cast<int>(found_.size()));
    found_.push_back(std::move(sighting));
  }
  std::vector<Sighting> take() { return std::move(found_); }

 private:
  static constexpr int kCellPx = 16;
  static int cell(float pixel, int cells) {
    return std::clamp(static_cast<int>(pixel) / kCellPx, 0, cells - 1);
  }
  int columns_;
  int rows_;
  std::vector<std::vector<int>> cells_;
  std::vector<Sighting> found_;
};

/// Keypoints for the sightings; those that hold a landmark already are not used again.
std::vector<int> add_keypoints(const std::vector<Sighting>& sightings, const Camera& camera,
                               double max_keypoint_depth_m, const SearchPointsOptions& options,
                               OrbExtractor& extractor, Keyframe& keyframe) {
  Features features = *keyframe.features;
  std::vector<char> taken(keyframe.landmarks.size());
  for (std::size_t k = 0; k < taken.size(); ++k) taken[k] = keyframe.landmarks[k] != kNone ? 1 : 0;
  std::vector<FoundPoint> points;
  for (const Sighting& sighting : sightings) points.push_back(sighting.point);
  extractor.set_image(keyframe.pyramid->levels.front());
  std::vector<int> placed = place_points(points, camera, options.snap_px, options.points.levels,
                                         extractor, taken, features);
  extractor.describe(features);
  keyframe.landmarks.resize(features.keypoints.size(), kNone);
  keyframe.labels.resize(features.keypoints.size(), 0);
  for (const int k : placed) {
    if (k == kNone) continue;
    Keypoint& keypoint = features.keypoints[static_cast<std::size_t>(k)];
    if (!keyframe.depth.empty()) {
      keypoint.depth = depth_at(keyframe.depth, keypoint.raw, max_keypoint_depth_m);
    }
    if (!keyframe.label_image.empty()) {
      keyframe.labels[static_cast<std::size_t>(k)] = label_at(keyframe.label_image, keypoint.raw);
    }
  }
  keyframe.features = std::make_shared<const Features>(std::move(features));
  return placed;
}

}  // namespace

std::vector<std::uint8_t>& SearchLog::of(KeyframeId keyframe, std::size_t keypoints) {
  const auto at = static_cast<std::size_t>(keyframe);
  if (counts_.size() <= at) counts_.resize(at + 1);
  if (counts_[at].size() < keypoints) counts_[at].resize(keypoints, 0);
  return counts_[at];
}

std::vector<Sighting> search_points(const Map& map, KeyframeId id, const Camera& camera,
                                    const SearchPointsOptions& options, SearchLog& log) {
  Sightings sightings(camera);
  const Keyframe& keyframe = map.keyframes.at(id);
  int searched = 0;
  for (const KeyframeId neighbour_id : best_neighbours(map, id, 20)) {
    const Keyframe& neighbour = map.keyframes.at(neighbour_id);
    if (neighbour.pyramid == nullptr) continue;
    const auto range = depth_range(map, neighbour, options);
    const double baseline = (keyframe.centre_world() - neighbour.centre_world()).norm();
    if (!range || baseline * range->median < options.min_baseline_share) continue;
    EpipolarSearch search(camera, neighbour, keyframe, *range, options);
    std::vector<std::uint8_t>& counts = log.of(neighbour_id, neighbour.landmarks.size());
    for (const int k : free_keypoints(neighbour, counts, options)) {
      ++counts[static_cast<std::size_t>(k)];
      if (auto sighting = search.find(k)) sightings.add(std::move(*sighting));
    }
    if (++searched == options.neighbours) break;
  }
  return sightings.take();
}

void put_sightings(Map& map, KeyframeId id, const Camera& camera, const cv::Mat& image,
                   double max_keypoint_depth_m, const std::vector<Sighting>& sightings,
                   const SearchPointsOptions& options, OrbExtractor& extractor,
                   PointMappingStats& stats) {
  const std::vector<int> placed = add_keypoints(sightings, camera, max_keypoint_depth_m, options,
                                                extractor, map.keyframes.at(id));
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    if (placed[i] == kNone) continue;
    const Sighting& sighting = sightings[i];
    const Keypoint& keypoint =
        map.keyframes.at(id).features->keypoints[static_cast<std::size_t>(placed[i])];
    const LandmarkId landmark = put_landmark(map, sighting.position, id, image, keypoint);
    map.add_observation(landmark, id, placed[i]);
    for (const Observation& seen : sighting.seen) {
      map.add_observation(landmark, seen.keyframe, seen.keypoint);
    }
    map.update_landmark_summary(landmark, options.points.levels);
    ++stats.triangulated;
  }
}

}  // namespace planecast::slam
