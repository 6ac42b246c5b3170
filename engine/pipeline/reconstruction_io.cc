#include "engine/pipeline/reconstruction_io.h"

#include <fmt/format.h>

#include "engine/output/atomic_file.h"
#include "engine/output/map_changes.h"
#include "engine/output/match_move.h"
#include "engine/output/match_move_camera.h"
#include "engine/output/planes_json.h"
#include "engine/output/ply.h"
#include "engine/output/summary.h"
#include "engine/output/tables.h"
#include "engine/output/trajectory.h"
#include "engine/pipeline/map_bin.h"
#include "engine/sequence/groundtruth.h"
#include "engine/user_error.h"

namespace planecast::engine {
namespace {

namespace fs = std::filesystem;
using PoseOfFrame = std::optional<slam::Pose> FrameRecord::*;

std::vector<TimedPose> poses_of(const std::vector<FrameRecord>& frames, PoseOfFrame member) {
  std::vector<TimedPose> poses;
  for (const FrameRecord& frame : frames) {
    if (frame.*member) poses.push_back({frame.timestamp, *(frame.*member)});
  }
  return poses;
}

std::vector<TimedPose> poses_of(const std::vector<KeyframeRecord>& keyframes) {
  std::vector<TimedPose> poses;
  for (const KeyframeRecord& keyframe : keyframes) {
    poses.push_back({keyframe.timestamp, keyframe.world_from_cam});
  }
  return poses;
}

/// Position in `frames` of each pose of a trajectory file, by exact time, in ascending order.
std::vector<std::size_t> frames_of(const std::vector<TimedPose>& poses,
                                   const std::vector<FrameRecord>& frames, const fs::path& path) {
  std::vector<std::size_t> positions;
  std::size_t next = 0;
  for (const TimedPose& pose : poses) {
    while (next < frames.size() && frames[next].timestamp != pose.timestamp) ++next;
    if (next == frames.size()) {
      throw UserError(
          fmt::format("{}: no frame of frames.csv has the time {} (or it is out of order)",
                      path.string(), format_timestamp(pose.timestamp)));
    }
    positions.push_back(next++);
  }
  return positions;
}

void read_frame_poses(const fs::path& path, PoseOfFrame member, std::vector<FrameRecord>& frames) {
  const std::vector<TimedPose> poses = read_trajectory(path);
  const std::vector<std::size_t> positions = frames_of(poses, frames, path);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    frames[positions[i]].*member = poses[i].world_from_cam;
  }
}

std::vector<KeyframeRecord> read_keyframes(const fs::path& path,
                                           const std::vector<FrameRecord>& frames) {
  const std::vector<TimedPose> poses = read_trajectory(path);
  const std::vector<std::size_t> positions = frames_of(poses, frames, path);
  std::vector<KeyframeRecord> keyframes;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    keyframes.push_back({frames[positions[i]].index, poses[i].timestamp, poses[i].world_from_cam});
  }
  return keyframes;
}

}  // namespace

void write_reconstruction(const Reconstruction& reconstruction, const fs::path& folder) {
  make_folder(folder);
  const std::vector<FrameRecord>& frames = reconstruction.frames;
  write_trajectory(poses_of(frames, &FrameRecord::world_from_cam), folder / "trajectory.txt");
  write_trajectory(poses_of(frames, &FrameRecord::causal_world_from_cam),
                   folder / "trajectory_causal.txt");
  write_trajectory(poses_of(reconstruction.keyframes), folder / "keyframes.txt");
  write_map_changes(reconstruction.map_changes, folder / "map_changes.csv");
  write_planes_json({reconstruction.metric, reconstruction.planes, reconstruction.up,
                     reconstruction.up_confidence},
                    folder / "planes.json");
  write_ply(reconstruction.points, folder / "map.ply");
  write_match_move(reconstruction, folder / "scene.glb");
  write_chan(reconstruction, folder / "camera.chan");
  write_frames_csv(frames, folder / "frames.csv");
  write_times_csv(reconstruction, folder / "times.csv");
  write_timings_json(reconstruction, folder / "timings.json");
  write_summary(reconstruction, folder / "summary.json");
  write_map_bin(reconstruction, folder / "map.bin");
}

Reconstruction read_reconstruction(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    throw UserError(fmt::format("{}: no such reconstruction folder", folder.string()));
  }
  if (!fs::exists(folder / "map.bin", error)) {
    throw UserError(
        fmt::format("{}: is not a reconstruction folder (it has no map.bin)", folder.string()));
  }
  Reconstruction reconstruction;
  read_map_bin(folder / "map.bin", reconstruction);
  reconstruction.frames = read_frames_csv(folder / "frames.csv");
  read_frame_poses(folder / "trajectory.txt", &FrameRecord::world_from_cam, reconstruction.frames);
  read_frame_poses(folder / "trajectory_causal.txt", &FrameRecord::causal_world_from_cam,
                   reconstruction.frames);
  reconstruction.keyframes = read_keyframes(folder / "keyframes.txt", reconstruction.frames);
  reconstruction.map_changes = read_map_changes(folder / "map_changes.csv");
  PlaneSet planes = read_planes_json(folder / "planes.json");
  reconstruction.planes = std::move(planes.planes);
  reconstruction.up = planes.up;
  reconstruction.up_confidence = planes.up_confidence;
  reconstruction.points = read_ply(folder / "map.ply");
  // The figures are nothing that a render needs: folders without them are good.
  if (fs::exists(folder / "times.csv", error)) {
    reconstruction.frame_times = read_times_csv(folder / "times.csv");
  }
  if (fs::exists(folder / "timings.json", error)) {
    reconstruction.timings = read_timings_json(folder / "timings.json");
  }
  if (fs::exists(folder / "summary.json", error)) {
    reconstruction.plane_rms = read_plane_rms(folder / "summary.json");
  }
  return reconstruction;
}

}  // namespace planecast::engine
