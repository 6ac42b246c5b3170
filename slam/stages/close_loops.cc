#include "slam/stages/close_loops.h"

#include <algorithm>
#include <utility>

namespace planecast::slam {
namespace {

/// Where everything that hangs on a keyframe goes: its camera before, and after as a similarity
/// that maps the new world to the camera in the old units.
struct Movement {
  Pose before = Pose::Identity();
  Similarity after;

  Similarity new_from_old_world() const { return after.inverse() * similarity_from_pose(before); }
};
using Movements = std::vector<Movement>;  ///< by keyframe id

/// The living keyframe that a landmark goes along with.
KeyframeId reference_of(const Map& map, const Landmark& landmark) {
  if (map.keyframes.contains(landmark.first_keyframe)) return landmark.first_keyframe;
  return landmark.observations.empty() ? kNone : landmark.observations.front().keyframe;
}

KeyframeId reference_of(const Map& map, const Plane& plane) {
  for (const KeyframeId observer : plane.observers) {
    const KeyframeId living = map.living_ancestor(observer);
    if (living != kNone) return living;
  }
  return map.keyframes.empty() ? kNone : (*map.keyframes.begin()).id;
}

void move_plane(const Similarity& new_from_old, Plane& plane) {
  plane.normal = (new_from_old.rotation * plane.normal).normalized();
  plane.x_axis = (new_from_old.rotation * plane.x_axis).normalized();
  plane.origin = new_from_old * plane.origin;
  plane.offset = -plane.normal.dot(plane.origin);
  plane.rms *= new_from_old.scale;
  for (Eigen::Vector3d& point : plane.depth_points) point = new_from_old * point;
}

void move_planes(const Movements& movements, Map& map) {
  for (Plane& plane : map.planes) {
    const KeyframeId reference = reference_of(map, plane);
    if (reference == kNone) continue;
    move_plane(movements[static_cast<std::size_t>(reference)].new_from_old_world(), plane);
  }
}

void move_keyframes(const Movements& movements, Map& map) {
  const KeyframeId origin = (*map.keyframes.begin()).id;
  for (Keyframe& keyframe : map.keyframes) {
    if (keyframe.id == origin) continue;
    const Similarity& after = movements[static_cast<std::size_t>(keyframe.id)].after;
    keyframe.cam_from_world = pose_in_source_units(after);
    keyframe.cam_from_world.linear() =
        Eigen::Quaterniond(after.rotation).normalized().toRotationMatrix();
    keyframe.unit /= after.scale;
  }
}

/// Landmarks that were recorded before duplicates were fused: position and reference then.
struct LandmarkPlace {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  KeyframeId reference = kNone;
};

std::vector<LandmarkPlace> places_of_landmarks(const Map& map) {
  std::vector<LandmarkPlace> places(static_cast<std::size_t>(map.landmarks.next_id()));
  for (const Landmark& landmark : map.landmarks) {
    places[static_cast<std::size_t>(landmark.id)] = {landmark.position,
                                                     reference_of(map, landmark)};
  }
  return places;
}

std::vector<KeyframeId> group_of(const Map& map, KeyframeId keyframe) {
  std::vector<KeyframeId> group = {keyframe};
  for (const auto& [id, shared] : map.covisible(keyframe)) group.push_back(id);
  std::sort(group.begin(), group.end());
  return group;
}

/// Joins the two sides' duplicates: the matches, and what else of the older side is found in the
/// keyframes about the newer. Poses of both sides must already agree.
void fuse_sides(const LoopMatch& match, const Camera& camera, const LoopOptions& options,
                Map& map) {
  const KeyframeId newer = map.living_ancestor(match.keyframe);
  const KeyframeId older = map.living_ancestor(match.loop_keyframe);
  if (newer == kNone || older == kNone) return;
  const std::vector<KeyframeId> group = group_of(map, newer);
  if (newer == match.keyframe) {
    for (std::size_t k = 0; k < match.matches.size(); ++k) {
      const LandmarkId older_landmark =
          match.matches[k] == kNone ? kNone : map.resolve(match.matches[k]);
      if (older_landmark == kNone) continue;
      const LandmarkId present = map.keyframes.at(newer).landmarks[k];
      if (present == kNone) {
        map.add_observation(older_landmark, newer, static_cast<int>(k));
      } else {
        map.replace_landmark(present, older_landmark);
      }
    }
  }
  const std::vector<LandmarkId> around = landmarks_around(map, older);
  PointMappingStats stats;
  for (const KeyframeId id : group) {
    fuse_landmarks_into(map, around, id, camera, options.points, stats);
  }
}

/// The pose graph and how its nodes and the keyframes belong together.
class EssentialGraph {
 public:
  explicit EssentialGraph(const Map& map)
      : node_of_(static_cast<std::size_t>(map.keyframes.next_id()), -1) {
    for (const Keyframe& keyframe : map.keyframes) {
      node_of_[static_cast<std::size_t>(keyframe.id)] = static_cast<int>(nodes.size());
      nodes.push_back({similarity_from_pose(keyframe.cam_from_world), nodes.empty()});
    }
  }

  PoseGraphNode& node(KeyframeId id) { return nodes[static_cast<std::size_t>(index_of(id))]; }
  void connect(KeyframeId from, KeyframeId to, const Similarity& to_from_from) {
    edges.push_back({index_of(from), index_of(to), to_from_from});
  }
  /// As the two stand now.
  void connect(KeyframeId from, KeyframeId to) {
    connect(from, to, node(to).cam_from_world * node(from).cam_from_world.inverse());
  }

  std::vector<PoseGraphNode> nodes;
  std::vector<PoseGraphEdge> edges;

 private:
  int index_of(KeyframeId id) const { return node_of_[static_cast<std::size_t>(id)]; }

  std::vector<int> node_of_;
};

/// Spanning tree, strong covisibility and earlier loops, as measured by the map.
void connect_map(const Map& map, int essential_weight, EssentialGraph& graph) {
  for (const Keyframe& keyframe : map.keyframes) {
    if (keyframe.parent != kNone) graph.connect(keyframe.parent, keyframe.id);
    for (const auto& [id, shared] : map.covisible(keyframe.id, essential_weight)) {
      if (id < keyframe.id && id != keyframe.parent) graph.connect(id, keyframe.id);
    }
  }
  for (const auto& [a, b] : map.loop_edges) graph.connect(a, b);
}

/// What fusing has newly tied to the group, strongly enough.
void connect_loop(const Map& map, const LoopMatch& match, const std::vector<KeyframeId>& group,
                  const std::vector<std::vector<KeyframeId>>& known, int essential_weight,
                  EssentialGraph& graph) {
  graph.connect(match.loop_keyframe, match.keyframe);
  for (std::size_t g = 0; g < group.size(); ++g) {
    for (const auto& [id, shared] : map.covisible(group[g], essential_weight)) {
      const bool same_side = std::binary_search(group.begin(), group.end(), id) ||
                             std::binary_search(known[g].begin(), known[g].end(), id);
      const bool done = group[g] == match.keyframe && id == match.loop_keyframe;
      if (!same_side && !done) graph.connect(id, group[g]);
    }
  }
}

int count_kept(const Map& map, const LoopMatch& match) {
  const std::vector<LandmarkId> older = landmarks_around(map, match.loop_keyframe);
  const std::vector<LandmarkId>& seen = map.keyframes.at(match.keyframe).landmarks;
  int kept = 0;
  for (std::size_t k = 0; k < seen.size(); ++k) {
    if (match.matches[k] == kNone || seen[k] == kNone) continue;
    kept += seen[k] == map.resolve(match.matches[k]) &&
            std::binary_search(older.begin(), older.end(), seen[k]);
  }
  return kept;
}

void update_summaries(const ScaleLevels& levels, Map& map) {
  for (const Landmark& landmark : map.landmarks) map.update_landmark_summary(landmark.id, levels);
}

/// Where the keyframes of `map` go: as in the corrected map, or along with the nearest ancestor
/// there.
Movements movements_to(const Map& corrected, const Map& map) {
  Movements movements(static_cast<std::size_t>(map.keyframes.next_id()));
  for (const Keyframe& keyframe : map.keyframes) {
    KeyframeId known = keyframe.id;
    while (known != kNone && !corrected.keyframes.contains(known)) {
      known = map.keyframes.at(known).parent;
    }
    if (known == kNone) known = (*corrected.keyframes.begin()).id;
    const Keyframe& target = corrected.keyframes.at(known);
    Similarity corrected_cam = similarity_from_pose(target.cam_from_world);
    const double old_units = map.keyframe_unit(known) / target.unit;
    corrected_cam.scale *= old_units;
    corrected_cam.translation *= old_units;
    const Pose cam_from_known = keyframe.cam_from_world * map.keyframe_pose(known).inverse();
    movements[static_cast<std::size_t>(keyframe.id)] = {
        keyframe.cam_from_world, similarity_from_pose(cam_from_known) * corrected_cam};
  }
  return movements;
}

}  // namespace

LoopFinder::LoopFinder(const LoopOptions& options, const Camera& camera,
                       std::shared_ptr<const Vocabulary> vocabulary)
    : options_(options),
      camera_(camera),
      vocabulary_(std::move(vocabulary)),
      detector_(options.places) {}

std::optional<LoopMatch> LoopFinder::look(Map& map, KeyframeId keyframe) {
  describe_keyframes(map, *vocabulary_);
  if (pending_ || keyframe < resume_at_) return std::nullopt;
  for (const KeyframeId candidate : detector_.detect(map, keyframe)) {
    std::optional<LoopMatch> match =
        verify_loop(map, camera_, keyframe, candidate, options_.verify);
    if (!match) continue;
    pending_ = true;
    return match;
  }
  return std::nullopt;
}

void LoopFinder::closed(const Map& map) {
  pending_ = false;
  resume_at_ = map.keyframes.next_id() + options_.min_keyframes_between;
  detector_.reset();
}

void LoopFinder::reset() {
  pending_ = false;
  resume_at_ = 0;
  detector_.reset();
}

std::optional<LoopCorrection> correct_loop(Map map, const Camera& camera, const LoopMatch& match,
                                           const LoopOptions& options) {
  LoopCorrection correction;
  correction.match = match;
  EssentialGraph graph(map);
  connect_map(map, options.essential_weight, graph);
  const std::vector<LandmarkPlace> places = places_of_landmarks(map);
  Movements movements(static_cast<std::size_t>(map.keyframes.next_id()));
  for (const Keyframe& keyframe : map.keyframes) {
    movements[static_cast<std::size_t>(keyframe.id)].before = keyframe.cam_from_world;
  }

  // The newer side moves onto the older one as a whole, so that duplicates are found.
  const std::vector<KeyframeId> group = group_of(map, match.keyframe);
  std::vector<std::vector<KeyframeId>> known;
  for (const KeyframeId id : group) known.push_back(group_of(map, id));
  const Similarity corrected =
      match.cam_from_loop_cam *
      similarity_from_pose(map.keyframes.at(match.loop_keyframe).cam_from_world);
  const Pose keyframe_from_old_world = map.keyframes.at(match.keyframe).cam_from_world;
  for (const KeyframeId id : group) {
    if (graph.node(id).fixed) continue;
    Keyframe& keyframe = map.keyframes.at(id);
    const Pose cam_from_keyframe = keyframe.cam_from_world * keyframe_from_old_world.inverse();
    graph.node(id).cam_from_world = similarity_from_pose(cam_from_keyframe) * corrected;
    keyframe.cam_from_world = pose_in_source_units(graph.node(id).cam_from_world);
  }
  fuse_sides(match, camera, options, map);
  connect_loop(map, match, group, known, options.essential_weight, graph);

  PoseGraphOptions solve;
  solve.with_scale = !options.rgbd;
  const double depth = map.median_depth(match.loop_keyframe);
  if (depth > 0.0) solve.length = depth;
  correction.graph = solve_pose_graph(graph.nodes, graph.edges, solve);
  for (const Keyframe& keyframe : map.keyframes) {
    movements[static_cast<std::size_t>(keyframe.id)].after = graph.node(keyframe.id).cam_from_world;
  }
  move_keyframes(movements, map);
  move_planes(movements, map);
  for (Landmark& landmark : map.landmarks) {
    const LandmarkPlace& place = places[static_cast<std::size_t>(landmark.id)];
    if (place.reference == kNone) continue;
    landmark.position =
        movements[static_cast<std::size_t>(place.reference)].new_from_old_world() * place.position;
  }

  Camera held = camera;
  correction.bundle = global_bundle(map, held, options.bundle);
  correction.kept_matches = count_kept(map, match);
  if (correction.kept_matches < options.min_kept_share * match.count) return std::nullopt;
  correction.map = std::move(map);
  return correction;
}

void carry_over(const LoopCorrection& correction, const Camera& camera, const LoopOptions& options,
                Map& map) {
  const Movements movements = movements_to(correction.map, map);
  for (Landmark& landmark : map.landmarks) {
    const LandmarkId known = correction.map.resolve(landmark.id);
    const KeyframeId reference = reference_of(map, landmark);
    if (known != kNone) {
      landmark.position = correction.map.landmarks.at(known).position;
    } else if (reference != kNone) {
      landmark.position =
          movements[static_cast<std::size_t>(reference)].new_from_old_world() * landmark.position;
    }
  }
  move_planes(movements, map);
  move_keyframes(movements, map);
  fuse_sides(correction.match, camera, options, map);
  const KeyframeId newer = map.living_ancestor(correction.match.keyframe);
  const KeyframeId older = map.living_ancestor(correction.match.loop_keyframe);
  if (newer != kNone && older != kNone && newer != older) map.loop_edges.emplace_back(older, newer);
  update_summaries(options.points.levels, map);
}

}  // namespace planecast::slam
