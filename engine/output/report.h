#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <opencv2/core.hpp>
#include <string>
#include <utility>
#include <vector>

#include "engine/pipeline/reconstruction.h"
#include "engine/scene/object_record.h"

namespace planecast::engine {

struct ReportStill {
  std::string caption;
  cv::Mat bgr;  ///< embedded as JPEG, at most 960 pixels wide
};

struct ReportInput {
  std::string title;
  std::string command;                                        ///< the exact command line
  std::vector<std::pair<std::string, std::string>> facts;     ///< name and value, above the counts
  std::vector<std::pair<std::string, std::string>> versions;  ///< of the program and its libraries
  std::vector<std::string> warnings;                          ///< beside the reconstruction's own
  std::vector<std::string> links;   ///< files beside the report, such as augmented.mp4
  std::filesystem::path video;      ///< empty: none
  double fps = 30.0;                ///< of the video
  std::vector<ReportStill> stills;  ///< shown where the video is not embedded
  std::vector<ObjectRecord> objects;
  std::map<int, StageTimes> render_times;  ///< by frame
  /// Larger videos are linked instead: a phone has to hold the whole page in memory.
  std::uintmax_t max_video_bytes = 24U << 20U;
};

/// The comments between which a report holds times of computing: all else is the same bytes for
/// the same input.
inline constexpr const char* kTimesBegin = "<!-- times: differ from run to run -->";
inline constexpr const char* kTimesEnd = "<!-- end of times -->";

/// A self-contained HTML page, nothing loaded from outside, readable on a phone (docs/report.md):
/// video or stills, the map in 3D (a drawing where the 3D view was not built or cannot run), charts
/// by frame, planes, warnings, timings, command and versions. Throws UserError where the video
/// cannot be read or the page not be written.
void write_report(const Reconstruction& reconstruction, const ReportInput& input,
                  const std::filesystem::path& path);

}  // namespace planecast::engine
