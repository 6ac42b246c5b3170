#include <cmath>
#include <cstddef>

#include "slam/stages/plane_steps.h"

namespace planecast::slam {

namespace {

constexpr double kChi2Pixel = 5.991;  ///< 95 %, 2 degrees of freedom
constexpr double kChi2Depth = 7.815;  ///< 95 %, 3 degrees of freedom
constexpr double kChi2Move = 3.841;   ///< 95 %, 1 degree of freedom
/// Share of a plane's landmarks in the keyframe beyond which it is the plane that is wrong, and how
/// many landmarks it takes to say so.
constexpr double kPlaneAtFault = 0.4;
constexpr int kMinForFault = 10;

struct Member {
  LandmarkId landmark;
  double band;
};

/// The keyframe's landmarks by the plane that they own; landmarks of planes that are gone are let
/// go.
std::vector<std::vector<Member>> members_in(Map& map, KeyframeId id, const PlaneContext& context) {
  std::vector<std::vector<Member>> result(static_cast<std::size_t>(map.planes.next_id()));
  const Keyframe& keyframe = map.keyframes.at(id);
  for (const LandmarkId landmark_id : keyframe.landmarks) {
    Landmark* landmark = map.landmarks.find(landmark_id);
    if (landmark == nullptr || landmark->plane == kNone) continue;
    if (!map.planes.contains(landmark->plane)) {
      landmark->plane = kNone;
      continue;
    }
    const double z = (keyframe.cam_from_world * landmark->position).z();
    result[landmark->plane].push_back({landmark_id, band_of(context, z)});
  }
  return result;
}

std::vector<LandmarkId> far_members(const Map& map, const Plane& plane,
                                    const std::vector<Member>& members,
                                    const PlaneContext& context) {
  std::vector<LandmarkId> result;
  for (const Member& member : members) {
    const double distance = plane.signed_distance(map.landmarks.at(member.landmark).position);
    if (std::abs(distance) > member.band * context.scale.eps_d) result.push_back(member.landmark);
  }
  return result;
}

/// Squared residual of one sight over sigma^2, with depth as in PoseOptions; infinite behind it.
double chi2_of(const Map& map, const Observation& observation, const Eigen::Vector3d& position,
               const PlaneContext& context) {
  const ScaleLevels levels;
  constexpr double kDepthBaselineM = 0.08;
  const Keyframe& keyframe = map.keyframes.at(observation.keyframe);
  const Keypoint& keypoint = keyframe.features->keypoints[observation.keypoint];
  const Eigen::Vector3d point_cam = keyframe.cam_from_world * position;
  if (!(point_cam.z() > 0.0)) return HUGE_VAL;
  const double sigma = levels.sigma_px(keypoint.octave);
  double squared =
      (context.camera.project(point_cam) - keypoint.pixel.cast<double>()).squaredNorm();
  if (context.rgbd && keypoint.depth > 0.0F) {
    const double disparity = kDepthBaselineM * std::abs(context.camera.fx) *
                             (1.0 / point_cam.z() - 1.0 / keypoint.depth);
    squared += disparity * disparity;
  }
  return squared / (sigma * sigma);
}

/// Whether the landmark's sights allow the move along the normal: each must still pass its test,
/// and together they may not speak against it, which is a test of one degree of freedom [D]. A
/// point that many keyframes hold is not dragged off by a plane that is known less well than the
/// point.
bool sights_allow(const Map& map, const Landmark& landmark, const Eigen::Vector3d& projected,
                  const PlaneContext& context) {
  double rise = 0.0;
  for (const Observation& observation : landmark.observations) {
    const Keyframe& keyframe = map.keyframes.at(observation.keyframe);
    const bool depth =
        context.rgbd && keyframe.features->keypoints[observation.keypoint].depth > 0.0F;
    const double after = chi2_of(map, observation, projected, context);
    if (after > (depth ? kChi2Depth : kChi2Pixel)) return false;
    rise += after - chi2_of(map, observation, landmark.position, context);
  }
  return rise < kChi2Move;
}

}  // namespace

int cull_far_landmarks(Map& map, KeyframeId keyframe, const PlaneContext& context) {
  const auto members = members_in(map, keyframe, context);
  std::vector<PlaneSupport> support;
  int removed = 0;
  for (Plane& plane : map.planes) {
    const std::vector<Member>& own = members[plane.id];
    std::vector<LandmarkId> far = far_members(map, plane, own, context);
    const bool at_fault = static_cast<int>(own.size()) >= kMinForFault &&
                          static_cast<double>(far.size()) > kPlaneAtFault * own.size();
    if (at_fault) {
      if (support.empty()) support = gather_support(map, context);
      refit_robustly(plane, support[plane.id], context);
      far = far_members(map, plane, own, context);
      for (const LandmarkId id : far) map.landmarks.at(id).plane = kNone;
      continue;
    }
    for (const LandmarkId id : far) map.erase_landmark(id);
    removed += static_cast<int>(far.size());
  }
  return removed;
}

RefineCounts project_landmarks(Map& map, KeyframeId keyframe, const PlaneContext& context) {
  RefineCounts counts;
  std::vector<char> seen(static_cast<std::size_t>(map.planes.next_id()), 0);
  for (const LandmarkId id : map.keyframes.at(keyframe).landmarks) {
    const Landmark* landmark = map.landmarks.find(id);
    if (landmark != nullptr && map.planes.contains(landmark->plane)) seen[landmark->plane] = 1;
  }
  const std::vector<PlaneSupport> support = gather_support(map, context);
  for (const Plane& plane : map.planes) {
    const PlanePoints& points = support[static_cast<std::size_t>(plane.id)].points;
    const double eps = own_eps({plane.normal, plane.offset}, points, context.scale);
    if (plane.weak || !is_sharp(eps, context.scale)) seen[static_cast<std::size_t>(plane.id)] = 0;
  }
  for (Landmark& landmark : map.landmarks) {
    if (landmark.plane == kNone || !map.planes.contains(landmark.plane)) continue;
    const Plane& plane = map.planes.at(landmark.plane);
    if (!seen[plane.id]) continue;
    const double distance = plane.signed_distance(landmark.position);
    if (std::abs(distance) > context.scale.eps_d) continue;
    const Eigen::Vector3d projected = landmark.position - distance * plane.normal;
    if (sights_allow(map, landmark, projected, context)) {
      landmark.position = projected;
      ++counts.refined;
    } else {
      ++counts.refused;
    }
  }
  return counts;
}

}  // namespace planecast::slam
