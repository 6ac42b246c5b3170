#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/pipeline/reconstruction.h"

namespace planecast::engine {

/// frames.csv: `index,timestamp,state,reason,inliers`, one line a frame, no times of computing, so
/// that it is repeatable.
void write_frames_csv(const std::vector<FrameRecord>& frames, const std::filesystem::path& path);
/// Reads it back without poses. Throws UserError naming file and line.
std::vector<FrameRecord> read_frames_csv(const std::filesystem::path& path);

/// times.csv: `index` and milliseconds by stage (columns in order of first appearance; empty where
/// a frame had no such stage).
void write_times_csv(const Reconstruction& reconstruction, const std::filesystem::path& path);
/// The times by frame, in the file's order. Throws UserError naming file and line.
std::vector<StageTimes> read_times_csv(const std::filesystem::path& path);

/// Names of the rows of the paper's Table 2, in its order.
std::vector<std::string> paper_timing_names();

/// The rows of the paper's Table 2 in its order, then every other stage. A row's samples are the
/// keyframes' (mapping_times) or, where there are none, the frames' (frame_times) under its name;
/// "Tracking" without samples of its own is the sum of a frame's stages but for the segmentation.
/// A reconstruction that was read back has its rows as they were.
std::vector<TimingRow> timing_rows(const Reconstruction& reconstruction);

/// timings.json: `{"unit": "ms", "rows": [{"name", "count", "mean", "median", "p95"}]}`.
void write_timings_json(const Reconstruction& reconstruction, const std::filesystem::path& path);
/// Its rows: name, count, mean, median and p95. Throws UserError naming the file.
std::vector<TimingRow> read_timings_json(const std::filesystem::path& path);

}  // namespace planecast::engine
