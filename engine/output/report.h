#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <utility>
#include <vector>

#include "engine/pipeline/reconstruction.h"

namespace planecast::engine {

struct ReportStill {
  std::string caption;
  cv::Mat bgr;  ///< embedded as JPEG, at most 960 pixels wide
};

struct ReportInput {
  std::string title;
  std::vector<ReportStill> stills;
  std::vector<std::pair<std::string, std::string>> facts;  ///< name and value, above the counts
  std::vector<std::string> warnings;                       ///< beside the reconstruction's own
  std::vector<std::string> links;  ///< files beside the report, such as augmented.mp4
};

/// A self-contained HTML page, nothing loaded from outside, readable on a phone: summary, stills,
/// top view of the map, inliers by frame, planes, timings, warnings. Throws UserError where it
/// cannot be written.
void write_report(const Reconstruction& reconstruction, const ReportInput& input,
                  const std::filesystem::path& path);

}  // namespace planecast::engine
