#include "engine/output/summary.h"

#include <map>
#include <nlohmann/json.hpp>

#include "engine/output/atomic_file.h"
#include "engine/output/json_text.h"
#include "engine/sequence/camera_file.h"
#include "engine/user_error.h"

namespace planecast::engine {
namespace {

using Json = nlohmann::ordered_json;

double share(int part, int whole) { return whole > 0 ? static_cast<double>(part) / whole : 0.0; }

Json frames_json(const Summary& summary) {
  Json json;
  json["count"] = summary.frames;
  json["tracked"] = summary.tracked;
  json["tracked_share"] = share(summary.tracked, summary.frames);
  json["localised"] = summary.localised;
  json["localised_share"] = share(summary.localised, summary.frames);
  json["lost"] = summary.lost;
  json["unreadable"] = summary.unreadable;
  json["until_initialised"] = summary.frames_until_initialised;
  json["first_tracked"] = summary.first_tracked_frame;
  json["mean_inliers"] = summary.mean_inliers;
  json["not_tracked_because"] = summary.not_tracked_because;
  return json;
}

}  // namespace

Summary summarise(const Reconstruction& reconstruction) {
  Summary summary;
  summary.frames = static_cast<int>(reconstruction.frames.size());
  summary.keyframes = static_cast<int>(reconstruction.keyframes.size());
  summary.planes = static_cast<int>(reconstruction.planes.size());
  summary.points = static_cast<int>(reconstruction.points.size());
  const slam::Pose* previous = nullptr;
  double inliers = 0.0;
  for (const FrameRecord& frame : reconstruction.frames) {
    if (frame.state == "lost") ++summary.lost;
    if (!frame.reason.empty()) ++summary.not_tracked_because[frame.reason];
    if (frame.state == "unreadable") ++summary.unreadable;
    if (frame.causal_world_from_cam) {
      if (summary.tracked == 0) summary.first_tracked_frame = frame.index;
      ++summary.tracked;
    } else if (summary.tracked == 0) {
      ++summary.frames_until_initialised;
    }
    if (!frame.world_from_cam) continue;
    ++summary.localised;
    inliers += frame.inliers;
    if (previous != nullptr) {
      summary.path_length += (frame.world_from_cam->translation() - previous->translation()).norm();
    }
    previous = &*frame.world_from_cam;
  }
  if (summary.localised > 0) summary.mean_inliers = inliers / summary.localised;
  for (const MapPoint& point : reconstruction.points) {
    if (point.plane != slam::kNone) ++summary.points_on_planes;
  }
  return summary;
}

Json summary_json(const Reconstruction& reconstruction) {
  const Summary summary = summarise(reconstruction);
  std::map<std::string, int> classes;
  for (const PlaneRecord& plane : reconstruction.planes) ++classes[plane.plane_class];
  Json json;
  json["mode"] = reconstruction.mode;
  json["segmentation"] = reconstruction.segmentation;
  json["units"] = reconstruction.metric ? "metres" : "map";
  json["camera"] = camera_json(reconstruction.camera);
  json["frames"] = frames_json(summary);
  json["keyframes"] = summary.keyframes;
  json["points"] = summary.points;
  json["points_on_planes"] = summary.points_on_planes;
  json["planes"] = summary.planes;
  json["planes_by_class"] = classes;
  if (reconstruction.plane_rms) {
    json["point_plane_rms"]["before"] = reconstruction.plane_rms->before;
    json["point_plane_rms"]["after"] = reconstruction.plane_rms->after;
  }
  json["median_depth"] = reconstruction.median_depth;
  json["path_length"] = summary.path_length;
  json["warnings"] = reconstruction.warnings;
  if (!reconstruction.stopped.empty()) json["stopped"] = reconstruction.stopped;
  return json;
}

void write_summary(const Reconstruction& reconstruction, const std::filesystem::path& path) {
  write_file(path, json_text(summary_json(reconstruction)) + "\n");
}

std::optional<PlaneRms> read_plane_rms(const std::filesystem::path& path) {
  const nlohmann::json json = nlohmann::json::parse(read_file(path), nullptr, false);
  if (!json.is_object()) throw UserError(path.string() + ": is not a summary");
  if (!json.contains("point_plane_rms")) return std::nullopt;
  try {
    const nlohmann::json& rms = json["point_plane_rms"];
    return PlaneRms{rms.at("before").get<double>(), rms.at("after").get<double>()};
  } catch (const nlohmann::json::exception&) {
    throw UserError(path.string() + ": its point_plane_rms is broken");
  }
}

}  // namespace planecast::engine
