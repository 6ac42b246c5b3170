#include "slam/stages/match_patches.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

#include "slam/features/pyramid.h"
#include "slam/features/warp_patch.h"
#include "slam/geometry/change_of_view.h"
#include "slam/geometry/lens.h"

namespace planecast::slam {
namespace {

/// Beyond this angle between the views a patch is not looked for.
constexpr double kMinViewCosine = 0.5;

/// Normal of the surface about a landmark in a keyframe's camera: that of its plane, or else it
/// faces the camera.
Eigen::Vector3d surface_normal(const Map& map, const Keyframe& keyframe, const Landmark& landmark,
                               const Eigen::Vector3d& in_keyframe) {
  if (const Plane* plane = map.planes.find(landmark.plane)) {
    const Eigen::Vector3d normal = keyframe.cam_from_world.linear() * plane->normal;
    // Nearly edge-on the plane says nothing about the patch.
    if (std::abs(normal.dot(in_keyframe.normalized())) > 0.2) return normal;
  }
  return Eigen::Vector3d::UnitZ();
}

/// Landmarks by cell of the image, the most observed first.
struct Expected {
  const Landmark* landmark;
  Eigen::Vector2f raw;
  std::size_t cell;
};

std::vector<Expected> expect_all(const Map& map, const Camera& camera, const Pose& cam_from_world,
                                 const std::vector<LandmarkId>& candidates, int cell_px) {
  const auto columns = static_cast<std::size_t>(camera.width / cell_px + 1);
  std::vector<Expected> result;
  const Eigen::Vector3d centre = cam_from_world.inverse().translation();
  for (const LandmarkId id : candidates) {
    const Landmark& landmark = map.landmarks.at(id);
    const Eigen::Vector3d point_cam = cam_from_world * landmark.position;
    if (!(point_cam.z() > 0.0)) continue;
    if (!camera.contains(camera.project(point_cam))) continue;
    const Eigen::Vector2d raw = project_raw(camera, point_cam);
    if (!camera.contains(raw, kPatchSide / 2.0)) continue;
    if ((centre - landmark.position).normalized().dot(landmark.view_from) < kMinViewCosine) {
      continue;
    }
    const auto cell =
        static_cast<std::size_t>(raw.y()) / static_cast<std::size_t>(cell_px) * columns +
        static_cast<std::size_t>(raw.x()) / static_cast<std::size_t>(cell_px);
    result.push_back({&landmark, raw.cast<float>(), cell});
  }
  std::stable_sort(result.begin(), result.end(), [](const Expected& a, const Expected& b) {
    return a.landmark->observations.size() > b.landmark->observations.size();
  });
  return result;
}

}  // namespace

const Observation* nearest_observation(const Map& map, const Landmark& landmark,
                                       const Eigen::Vector3d& centre_world) {
  const Observation* nearest = nullptr;
  double least = std::numeric_limits<double>::max();
  for (const Observation& observation : landmark.observations) {
    const Keyframe& keyframe = map.keyframes.at(observation.keyframe);
    if (keyframe.pyramid == nullptr) continue;
    const double distance = (keyframe.centre_world() - centre_world).squaredNorm();
    if (distance < least) {
      least = distance;
      nearest = &observation;
    }
  }
  return nearest;
}

std::optional<PatchMatch> match_patch(const Map& map, const Camera& camera,
                                      const ImagePyramid& image, const Pose& cam_from_world,
                                      const Landmark& landmark, const Observation& seen,
                                      const Eigen::Vector2f& start_raw,
                                      const PatchMatchOptions& options) {
  const Keyframe& keyframe = map.keyframes.at(seen.keyframe);
  const Keypoint& keypoint = keyframe.features->keypoints[static_cast<std::size_t>(seen.keypoint)];
  const Pose cam_from_keyframe = cam_from_world * keyframe.cam_from_world.inverse();
  const Eigen::Vector3d in_keyframe = keyframe.cam_from_world * landmark.position;
  const auto view = change_of_view(
      camera, in_keyframe, surface_normal(map, keyframe, landmark, in_keyframe), cam_from_keyframe);
  if (!view) return std::nullopt;
  const auto patch = warp_patch(*keyframe.pyramid, keypoint, *view, image, options.levels);
  if (!patch) return std::nullopt;
  const auto alignment =
      align_patch(patch->looks, image.levels[static_cast<std::size_t>(patch->level)],
                  at_level(start_raw, patch->level), options.align);
  if (!alignment || alignment->correlation < options.min_correlation) return std::nullopt;
  PatchMatch match;
  match.landmark = landmark.id;
  match.raw = from_level(alignment->pixel, patch->level);
  match.pixel = camera.undistort(match.raw.cast<double>());
  match.level = patch->level;
  return match;
}

PatchMatches match_patches(const Map& map, const Camera& camera, const ImagePyramid& image,
                           const Pose& guess_cam_from_world,
                           const std::vector<LandmarkId>& candidates,
                           const PatchMatchOptions& options) {
  const int cell_px = std::max(8, options.cell_px * std::max(camera.width, camera.height) / 640);
  const Eigen::Vector3d centre = guess_cam_from_world.inverse().translation();
  std::vector<Expected> expected =
      expect_all(map, camera, guess_cam_from_world, candidates, cell_px);
  PatchMatches result;
  std::vector<int> tries(
      static_cast<std::size_t>((camera.width / cell_px + 1) * (camera.height / cell_px + 1)));
  for (int round = 0; round < options.rounds; ++round) {
    std::fill(tries.begin(), tries.end(), 0);
    for (Expected& candidate : expected) {
      if (static_cast<int>(result.matches.size()) >= options.max_matches) break;
      if (candidate.landmark == nullptr || tries[candidate.cell] != 0) continue;
      const Landmark& landmark = *std::exchange(candidate.landmark, nullptr);
      const Observation* seen = nearest_observation(map, landmark, centre);
      if (seen == nullptr) continue;
      ++tries[candidate.cell];
      result.tried.push_back(landmark.id);
      if (const auto match = match_patch(map, camera, image, guess_cam_from_world, landmark, *seen,
                                         candidate.raw, options)) {
        result.matches.push_back(*match);
      }
    }
  }
  std::sort(result.tried.begin(), result.tried.end());
  return result;
}

}  // namespace planecast::slam
