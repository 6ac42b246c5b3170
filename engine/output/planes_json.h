#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/pipeline/reconstruction.h"

namespace planecast::engine {

/// The content of a planes.json: of a reconstruction, or the truth of a synthetic sequence.
struct PlaneSet {
  bool metric = false;  ///< units are metres, else map units
  std::vector<PlaneRecord> planes;
  Eigen::Vector3d up = -Eigen::Vector3d::UnitY();  ///< unit, world
  double up_confidence = 0.0;
};

/// `{"units", "planes": [{"id", "normal", "offset", "class", "inliers", "rms", "area", "polygon",
/// "holes", "label", "first_frame", "merged_from", "origin", "x_axis"}], "up", "up_confidence"}`.
/// Numbers read back exactly. Beside the format's own keys, "origin" and "x_axis" give the plane's
/// own frame, in which anchors are kept.
std::string planes_json_text(const PlaneSet& set);
void write_planes_json(const PlaneSet& set, const std::filesystem::path& path);

/// Reads what write_planes_json writes. Of a plane only "id", "normal" and "offset" are required; a
/// missing frame is put at the polygon's mean (or the world origin's foot). Normals are made unit.
/// Throws UserError with one line naming the file and the faulty place.
PlaneSet read_planes_json(const std::filesystem::path& path);

}  // namespace planecast::engine
