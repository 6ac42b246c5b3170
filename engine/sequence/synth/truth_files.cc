#include "engine/sequence/synth/truth_files.h"

#include <fmt/format.h>

#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

#include "engine/user_error.h"

namespace planecast::engine::synth {

namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

Json to_json(const Eigen::Vector3d& v) {
  // Adding zero turns -0 into 0.
  return Json::array({v.x() + 0.0, v.y() + 0.0, v.z() + 0.0});
}

Json to_json(const TruePlane& plane, const PlaneSighting& sighting) {
  Json polygon = Json::array();
  for (const Eigen::Vector3d& corner : plane.polygon) polygon.push_back(to_json(corner));
  Json json;
  json["id"] = plane.label - 1;
  json["normal"] = to_json(plane.normal);
  json["offset"] = plane.offset + 0.0;
  json["class"] = plane.plane_class;
  json["inliers"] = sighting.pixels;
  json["rms"] = 0.0;
  json["area"] = plane.area;
  json["polygon"] = polygon;
  json["holes"] = Json::array();
  json["label"] = plane.label;
  json["first_frame"] = sighting.first_frame;
  json["merged_from"] = Json::array();
  return json;
}

void write_text(const fs::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  out.close();
  if (!out) throw UserError(file.string() + ": cannot be written");
}

}  // namespace

TruthFiles::TruthFiles(fs::path folder, const std::vector<TruePlane>& planes)
    : folder_(std::move(folder)), planes_(planes), sightings_(planes.size()) {
  rgb_ = "# color images\n# timestamp filename\n";
  depth_ = "# depth maps\n# timestamp filename\n";
  mask_ = "# plane instance masks\n# timestamp filename\n";
  trajectory_ = "# ground truth, world from camera\n# timestamp tx ty tz qx qy qz qw\n";
}

void TruthFiles::add_frame(const std::string& stamp, int frame, const slam::Pose& world_from_cam,
                           const cv::Mat& mask) {
  rgb_ += fmt::format("{0} rgb/{0}.png\n", stamp);
  depth_ += fmt::format("{0} depth/{0}.png\n", stamp);
  mask_ += fmt::format("{0} mask/{0}.png\n", stamp);
  const Eigen::Vector3d t = world_from_cam.translation();
  Eigen::Quaterniond q(world_from_cam.linear());
  if (q.w() < 0.0) q.coeffs() *= -1.0;
  trajectory_ += fmt::format("{} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n", stamp, t.x(),
                             t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
  std::array<long long, 256> count{};
  for (int y = 0; y < mask.rows; ++y) {
    const auto* label = mask.ptr<std::uint8_t>(y);
    for (int x = 0; x < mask.cols; ++x) ++count[label[x]];
  }
  for (std::size_t i = 0; i < sightings_.size() && i + 1 < count.size(); ++i) {
    PlaneSighting& sighting = sightings_[i];
    sighting.pixels += count[i + 1];
    if (sighting.first_frame < 0 && count[i + 1] > 0) sighting.first_frame = frame;
  }
}

void TruthFiles::write() const {
  write_text(folder_ / "rgb.txt", rgb_);
  write_text(folder_ / "depth.txt", depth_);
  write_text(folder_ / "mask.txt", mask_);
  write_text(folder_ / "groundtruth.txt", trajectory_);
  Json planes = Json::array();
  for (std::size_t i = 0; i < planes_.size(); ++i) {
    if (sightings_[i].pixels > 0) planes.push_back(to_json(planes_[i], sightings_[i]));
  }
  Json root;
  root["units"] = "metres";
  root["planes"] = planes;
  root["up"] = Json::array({0.0, 0.0, 1.0});
  root["up_confidence"] = 1.0;
  write_text(folder_ / "planes.json", root.dump(1) + "\n");
}

}  // namespace planecast::engine::synth
