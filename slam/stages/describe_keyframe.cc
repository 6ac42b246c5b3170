#include "slam/stages/describe_keyframe.h"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <utility>

#include "slam/features/matching.h"
#include "slam/features/place_points.h"

namespace planecast::slam {
namespace {

class Describer {
 public:
  Describer(const Map& map, const Camera& camera, const Pose& cam_from_world,
            const ImageFeatures& image, const DescribeKeyframeOptions& options, Features features)
      : map_(map),
        camera_(camera),
        cam_from_world_(cam_from_world),
        image_(image),
        options_(options),
        features_(std::move(features)) {}

  /// Features of the landmarks found by their looks.
  void place(const std::vector<PatchMatch>& patches, OrbExtractor& extractor) {
    const ScaleLevels& levels = options_.localise.levels;
    std::vector<FoundPoint> points;
    for (const PatchMatch& patch : patches) {
      const Landmark& landmark = map_.landmarks.at(patch.landmark);
      const double distance = (cam_from_world_ * landmark.position).norm();
      points.push_back({patch.raw, patch.pixel, predict_octave(landmark, distance, levels),
                        landmark.descriptor});
    }
    std::vector<char> taken(features_.keypoints.size(), 0);
    const std::vector<int> placed =
        place_points(points, camera_, options_.snap_px, levels, extractor, taken, features_);
    matches_.assign(features_.keypoints.size(), kNone);
    for (std::size_t i = 0; i < placed.size(); ++i) {
      if (placed[i] != kNone) matches_[static_cast<std::size_t>(placed[i])] = patches[i].landmark;
    }
  }

  /// Matches further landmarks by descriptor.
  void search(const std::vector<LandmarkId>& candidates) {
    std::vector<char> known(static_cast<std::size_t>(map_.landmarks.next_id()), 0);
    for (const LandmarkId id : matches_) {
      if (id != kNone) known[static_cast<std::size_t>(id)] = 1;
    }
    std::vector<Expectation> expectations;
    for (const LandmarkId id : candidates) {
      Expectation expectation;
      if (known[static_cast<std::size_t>(id)] == 0 &&
          expect_landmark(map_.landmarks.at(id), camera_, cam_from_world_, options_.localise.levels,
                          expectation)) {
        expectations.push_back(expectation);
      }
    }
    ExpectationMatchOptions match;
    match.ratio = options_.localise.local_map_ratio;
    const auto pairs = match_expectations(features_, expectations, matches_, match);
    for (const auto& [k, e] : pairs) {
      const Landmark& landmark =
          map_.landmarks.at(expectations[static_cast<std::size_t>(e)].landmark);
      matches_[static_cast<std::size_t>(k)] = landmark.id;
      settle(k, landmark);
    }
    features_.build_grid(camera_.width, camera_.height);
  }

  Features take_features() { return std::move(features_); }
  std::vector<LandmarkId> take_matches() { return std::move(matches_); }

 private:
  void move(int k, const PatchMatch& patch) {
    Keypoint& keypoint = features_.keypoints[static_cast<std::size_t>(k)];
    keypoint.raw = patch.raw;
    keypoint.pixel = patch.pixel.cast<float>();
  }

  /// Moves a matched feature to where it looks like the landmark, if that is near.
  void settle(int k, const Landmark& landmark) {
    const Observation* seen =
        nearest_observation(map_, landmark, cam_from_world_.inverse().translation());
    if (seen == nullptr) return;
    const Keypoint& keypoint = features_.keypoints[static_cast<std::size_t>(k)];
    const auto patch = match_patch(map_, camera_, *image_.pyramid, cam_from_world_, landmark, *seen,
                                   keypoint.raw, options_.patches);
    if (!patch) return;
    const double reach = options_.snap_px * options_.localise.levels.scale(keypoint.octave);
    if ((patch->raw - keypoint.raw).norm() < static_cast<float>(reach)) move(k, *patch);
  }

  const Map& map_;
  const Camera& camera_;
  const Pose& cam_from_world_;
  const ImageFeatures& image_;
  const DescribeKeyframeOptions& options_;
  Features features_;
  std::vector<LandmarkId> matches_;
};

}  // namespace

PoseEstimate describe_keyframe(const Map& map, const Camera& camera, const PoseEstimate& estimate,
                               const DescribeKeyframeOptions& options, ImagePreparer& preparer,
                               ImageFeatures& image) {
  Describer describer(map, camera, estimate.cam_from_world, image, options,
                      preparer.extract_raw(image));
  describer.place(estimate.patches, preparer.extractor());
  describer.search(
      landmarks_of(map, local_keyframes(map, supporting_landmarks(estimate), options.localise)));
  Features features = describer.take_features();
  preparer.add_depth(image, features);
  image.features = std::make_shared<const Features>(std::move(features));
  return optimise_matches(map, camera, *image.features, estimate.cam_from_world,
                          describer.take_matches(), options.localise.levels);
}

}  // namespace planecast::slam
