#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/sequence/synth.h"

namespace planecast::engine {

/// One sequence of a benchmark: on disk, or made by the generator.
struct BenchmarkSequence {
  std::string name;
  std::string group;                  ///< heading under which it is listed; may be empty
  std::filesystem::path path;         ///< on disk, made absolute by the data folder; empty: synth
  std::filesystem::path groundtruth;  ///< file or folder; empty: found in the sequence
  std::optional<SynthOptions> synth;
  std::string camera;                 ///< preset or file; empty: as `track` finds it
  std::string frames;                 ///< A:B; empty: all
  std::string size;                   ///< WxH; empty: as recorded
  std::vector<std::string> modes;     ///< mono, rgbd, auto
  std::vector<std::string> variants;  ///< names; empty: every variant
};

/// A way to run `track`: further options of its command line.
struct BenchmarkVariant {
  std::string name = "default";
  std::vector<std::string> options;
  std::vector<std::string> modes;  ///< empty: every mode
};

/// Curves of one metric over another, a line for each group of sequences.
struct BenchmarkCurve {
  std::string x;
  std::string y;
};

/// What others printed: figures[mode][sequence] as text, since some are "fails".
struct PublishedColumn {
  std::string name;
  std::string source;
  std::string metric;  ///< key of the metric that it stands beside
  std::map<std::string, std::map<std::string, std::string>> figures;
};

struct BenchmarkConfig {
  std::string title;
  std::string about;
  std::vector<BenchmarkSequence> sequences;
  std::vector<BenchmarkVariant> variants;
  std::vector<std::uint64_t> seeds;
  std::vector<std::string> options;  ///< of every run
  std::vector<std::string> tables;   ///< in this order
  std::vector<std::string> plots;
  std::vector<BenchmarkCurve> curves;
  std::vector<PublishedColumn> published;
};

/// Tables and plots that a configuration may ask for.
const std::vector<std::string>& benchmark_table_names();
const std::vector<std::string>& benchmark_plot_names();

/// Reads a configuration:
///
///     title: Built-in suite
///     about: one paragraph                  # may be left out, as may all below but sequences
///     seeds: 5                              # 1 to 5; or a list
///     modes: [mono, rgbd]                   # of sequences that name none; default auto
///     data: PLANECAST_DATASETS              # environment variable: where relative paths begin
///     data_default: ../datasets             # used where the variable is not set
///     options: [--threads, 2]               # of every run
///     variants:                             # default: one, named default
///       - {name: no planes, options: [--no-planes], modes: [mono]}
///     tables: [ate, tracking, planes, overlay, timings, resources, ablation]
///     plots: [ate, trajectories]
///     curves: [{x: frames, y: seconds}]     # of metrics, a line for each group
///     published: published.yaml             # beside this file
///     sequences:
///       - {name: fr1_xyz, path: rgbd_dataset_freiburg1_xyz, camera: tum-fr1, group: TUM RGB-D,
///          groundtruth: groundtruth.txt, frames: 0:300, size: 320x240, modes: [mono],
///          variants: [default]}
///       - {name: tabletop, synth: {scene: tabletop, frames: 300, width: 640, height: 480,
///          fps: 30, seed: 1, effects: true, lens: none}}
///
/// and the file of published figures:
///
///     columns:
///       - {name: ORB-SLAM2, source: where it is printed, metric: ate_cm,
///          mono: {fr1_xyz: 0.99}, rgbd: {fr1_xyz: 1.20}}
///
/// Throws UserError naming file and line for unknown keys, names that stand twice and values that
/// cannot be. Whether sequences are present is not looked at.
BenchmarkConfig read_benchmark_config(const std::filesystem::path& file);

}  // namespace planecast::engine
