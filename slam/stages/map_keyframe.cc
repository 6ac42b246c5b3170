#include "slam/stages/map_keyframe.h"

#include <opencv2/imgproc.hpp>
#include "slam/stages/stopwatch.h"

namespace planecast::slam {
namespace {

void append_plane_times(const PlaneMappingStats& stats, StageTimes& times) {
  times.emplace_back("Non-Planar Map Point Culling", stats.cull_ms);
  times.emplace_back("New Plane Detection", stats.new_ms);
  times.emplace_back("Plane Merging/Expanding", stats.merge_expand_ms);
  times.emplace_back("Plane Re-estimation", stats.reestimate_ms);
  times.emplace_back("Point-Plane Refinement", stats.refine_ms);
}

void count_visible(Map& map, const KeyframeJob& job) {
  for (const LandmarkId id : job.visible) {
    if (Landmark* landmark = map.landmarks.find(map.resolve(id))) ++landmark->visible;
  }
  for (const LandmarkId id : job.found) {
    if (Landmark* landmark = map.landmarks.find(map.resolve(id))) ++landmark->found;
  }
}

/// Landmarks that were merged since the tracker saw the map become their heirs; those that are gone
/// are left out, and one that two have become is kept once.
void follow(const Map& map, PoseEstimate& estimate) {
  std::vector<char> used(static_cast<std::size_t>(map.landmarks.next_id()), 0);
  const auto heir = [&](LandmarkId id) {
    const LandmarkId living = id == kNone ? kNone : map.resolve(id);
    if (living == kNone || used[static_cast<std::size_t>(living)] != 0) return kNone;
    used[static_cast<std::size_t>(living)] = 1;
    return living;
  };
  for (LandmarkId& id : estimate.matches) id = heir(id);
  for (PatchMatch& patch : estimate.patches) patch.landmark = heir(patch.landmark);
  std::erase_if(estimate.patches, [](const PatchMatch& patch) { return patch.landmark == kNone; });
}

/// Takes the keypoints that move, and match no landmark, out of an image's features.
void drop_moving(const Camera& camera, ImageFeatures& image, std::vector<LandmarkId>& matches) {
  const Features& all = *image.features;
  auto kept = std::make_shared<Features>();
  std::vector<LandmarkId> kept_matches;
  for (std::size_t k = 0; k < all.keypoints.size(); ++k) {
    if (matches[k] == kNone && image.moves_at(all.keypoints[k].raw)) continue;
    kept->keypoints.push_back(all.keypoints[k]);
    kept->descriptors.push_back(all.descriptors[k]);
    kept_matches.push_back(matches[k]);
  }
  kept->build_grid(camera.width, camera.height);
  image.features = std::move(kept);
  matches = std::move(kept_matches);
}

/// Nobody looks at a keyframe's masks again once its planes are mapped, nor at its depth but for
/// what it saw through, and they are most of its memory. Without depth a sixteenth of the masks is
/// kept for the end.
void release_images(Keyframe& keyframe, const FreeSpaceOptions& options) {
  constexpr double kCoarse = 0.25;
  if (!keyframe.depth.empty()) {
    keyframe.nearest_depth = nearest_depths(keyframe.depth, options);
  } else if (!keyframe.label_image.empty()) {
    cv::resize(keyframe.label_image, keyframe.coarse_labels, {}, kCoarse, kCoarse,
               cv::INTER_NEAREST);
  }
  keyframe.depth.release();
  keyframe.label_image.release();
}

}  // namespace

KeyframeMapper::KeyframeMapper(const KeyframeMapperOptions& options, const Camera& camera,
                               std::unique_ptr<PlaneSegmenter> segmenter)
    : options_(options),
      camera_(camera),
      segmenter_(std::move(segmenter)),
      preparer_(options.prepare, camera),
      plane_mapper_(options.planes, camera, options.rgbd) {}

void KeyframeMapper::reset() {
  plane_mapper_ = PlaneMapper(options_.planes, camera_, options_.rgbd);
  search_log_ = {};
}

void KeyframeMapper::segment(const ImageFeatures& image, Keyframe& keyframe, StageTimes& times) {
  Stopwatch watch;
  FrameInput frame;
  frame.index = image.frame_index;
  frame.timestamp = image.timestamp;
  frame.image = image.grey_or_bgr;
  frame.depth = image.depth;
  frame.labels = image.labels;
  // The segmenter alone says what counts as a mask, not what happened to come with the frame.
  keyframe.label_image = segmenter_->segment(frame);
  for (std::size_t k = 0; k < keyframe.labels.size(); ++k) {
    keyframe.labels[k] = label_at(keyframe.label_image, keyframe.features->keypoints[k].raw);
  }
  times.emplace_back("Instance Planar Segmentation", watch.lap_ms());
}

KeyframeReport KeyframeMapper::start(Map& map, const std::vector<ImageFeatures>& images) {
  KeyframeReport report;
  if (options_.map_planes) map_planes_at_start(map, images, report);
  for (Keyframe& keyframe : map.keyframes) release_images(keyframe, options_.free_space);
  return report;
}

void KeyframeMapper::map_planes_at_start(Map& map, const std::vector<ImageFeatures>& images,
                                         KeyframeReport& report) {
  std::size_t next = 0;
  for (Keyframe& keyframe : map.keyframes) {
    segment(images[next++], keyframe, report.times);
    report.keyframe = keyframe.id;
  }
  Stopwatch watch;
  for (const Keyframe& keyframe : map.keyframes) {
    plane_mapper_.cull_non_planar(map, keyframe.id, report.planes);
    plane_mapper_.update(map, keyframe.id, report.planes);
  }
  report.times.emplace_back("Point-Plane Map Initialization", watch.lap_ms());
}

void KeyframeMapper::leave_out_moving(const Map& map, KeyframeJob& job) const {
  if (job.image.depth.empty()) return;
  const KeyframeId reference = map.living_ancestor(job.reference);
  std::vector<KeyframeId> asked =
      best_neighbours(map, reference, static_cast<std::size_t>(options_.free_space.neighbours));
  asked.push_back(reference);
  job.image.moving = moving_parts(job.image.depth, job.estimate.cam_from_world, map, asked, camera_,
                                  options_.free_space);
  if (job.image.moving.empty()) return;
  job.image.depth = job.image.depth.clone();
  job.image.depth.setTo(0.0, job.image.moving);
  if (job.image.features != nullptr) drop_moving(camera_, job.image, job.estimate.matches);
}

KeyframeId KeyframeMapper::put_keyframe(Map& map, KeyframeJob& job, StageTimes& times) {
  // The map may have moved since the tracker saw it: the pose goes along with its reference.
  job.estimate.cam_from_world = map.from_keyframe(job.cam_from_reference, job.reference);
  follow(map, job.estimate);
  leave_out_moving(map, job);
  if (job.image.features == nullptr) {
    Stopwatch watch;
    job.estimate =
        describe_keyframe(map, camera_, job.estimate, options_.describe, preparer_, job.image);
    times.emplace_back("Keyframe Features", watch.lap_ms());
  }
  Keyframe keyframe = make_keyframe(job.image, job.estimate.cam_from_world, map);
  const KeyframeId id = keyframe.id;
  keyframe.parent = map.living_ancestor(job.reference);
  if (options_.map_planes) segment(job.image, keyframe, times);
  map.keyframes.put(std::move(keyframe));
  for (std::size_t k = 0; k < job.estimate.matches.size(); ++k) {
    const LandmarkId landmark = job.estimate.matches[k];
    if (landmark == kNone) continue;
    map.add_observation(landmark, id, static_cast<int>(k));
  }
  return id;
}

void KeyframeMapper::create_points(Map& map, KeyframeId id, const ImageFeatures& image,
                                   PointMappingStats& stats, StageTimes& times) {
  Stopwatch watch;
  double search_ms = 0.0;
  if (options_.search_by_patches) {
    const std::vector<Sighting> sightings =
        search_points(map, id, camera_, options_.search, search_log_);
    search_ms = watch.lap_ms();
    put_sightings(map, id, camera_, image.grey_or_bgr, options_.prepare.max_keypoint_depth_m,
                  sightings, options_.search, preparer_.extractor(), stats);
    times.emplace_back("Keyframe Descriptors", watch.lap_ms());
  } else {
    create_landmarks(map, id, camera_, options_.rgbd, image.grey_or_bgr, options_.points, stats);
  }
  if (options_.rgbd) {
    create_landmarks_from_depth(map, id, camera_, image.grey_or_bgr, options_.points, stats);
  }
  times.emplace_back("Triangulation", search_ms + watch.lap_ms());
}

KeyframeReport KeyframeMapper::insert(Map& map, KeyframeJob job) {
  KeyframeReport report;
  Stopwatch total;
  count_visible(map, job);
  const KeyframeId id = put_keyframe(map, job, report.times);
  report.keyframe = id;

  cull_landmarks(map, id, options_.rgbd, options_.points, report.points);
  if (options_.map_planes) plane_mapper_.cull_non_planar(map, id, report.planes);
  Stopwatch watch;
  create_points(map, id, job.image, report.points, report.times);
  watch.lap_ms();
  fuse_landmarks(map, id, camera_, options_.points, report.points);
  report.times.emplace_back("Fusing", watch.lap_ms());
  if (options_.map_planes) plane_mapper_.update(map, id, report.planes);
  watch.lap_ms();
  report.bundle = local_bundle(map, camera_, id, options_.bundle);
  report.times.emplace_back("Local BA", watch.lap_ms());
  if (options_.map_planes) {
    plane_mapper_.follow_map(map);
    append_plane_times(report.planes, report.times);
  }
  release_images(map.keyframes.at(id), options_.free_space);
  cull_keyframes(map, id, options_.points, report.points);
  report.times.emplace_back("Local Mapping", total.lap_ms());
  return report;
}

}  // namespace planecast::slam
