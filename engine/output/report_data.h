#pragma once

#include <string>

#include "engine/output/report.h"

namespace planecast::engine {

/// JSON as the content of a <script> element: nothing in it can end the element.
std::string script_json(const std::string& json);

/// What report.html's own scripts read, as JSON; the same for the same input:
///   units, fps, camera {width, height, fx, fy, cx, cy}, up [3],
///   frames {index, inliers, state, reason (numbers into states, reasons), pose: [x, y, z, qx, qy,
///   qz, qw] or null; world from camera}, states, reasons, keyframes [index],
///   planes [{id, class, color, origin, x, y (axes), outer [[u, v]], holes}],
///   points {count, position, color, plane: base64 of float32 x 3, uint8 x 3, int16},
///   objects [{name, plane, matrix (16, column-major), min, max, mesh: null or what report_mesh.h
///   says as base64 of float32 x 3, uint8 x 3, uint32 x 3}].
/// Of more than 30,000 points evenly many are left out.
std::string report_data_json(const Reconstruction& reconstruction, const ReportInput& input);

}  // namespace planecast::engine
