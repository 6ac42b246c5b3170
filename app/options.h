#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "app/console.h"
#include "engine/pipeline/reconstruction.h"
#include "engine/pipeline/track_sequence.h"
#include "engine/sequence/sequence.h"

namespace planecast::app {

/// What every command takes.
struct CommonOptions {
  bool quiet = false;
  bool verbose = false;
  bool no_progress = false;
  int threads = 2;
  std::uint64_t seed = 1;
  std::string json;  ///< file for the figures; "-": standard output, instead of the text

  Console console() const;
  /// The result of a command: `text` for a reader on standard output, and the figures where --json
  /// wants them. Throws UserError where they cannot be written.
  void print_result(const std::string& text, const nlohmann::ordered_json& figures) const;
};
void add_common_options(CLI::App& command, CommonOptions& options);
/// Parts of them: how much is printed; the threads.
void add_console_options(CLI::App& command, CommonOptions& options);
void add_threads_option(CLI::App& command, CommonOptions& options);
/// --json, for commands whose results a machine may read.
void add_json_option(CLI::App& command, CommonOptions& options);

/// Which frames of which sequence, seen by which camera.
struct InputOptions {
  std::string sequence;
  std::string camera;
  std::string frames;  ///< A:B
  std::string size;    ///< WxH
  bool skip_unreadable = false;

  std::unique_ptr<engine::Sequence> open() const;
};
void add_input_options(CLI::App& command, InputOptions& options);

/// --segmentation and --network.
void add_segmentation_options(CLI::App& command, std::string& segmentation, std::string& network);

/// SLAM's own options.
struct TrackingOptions {
  std::string mode = "auto";
  std::string segmentation = "auto";
  double mask_leakage = 0.0;
  std::string network;  ///< ONNX file; empty: our own
  std::string up;       ///< x,y,z
  std::string plane_merge = "default";
  std::string plane_fit = "graph-cut";
  bool causal = false;
  bool no_loop_closing = false;
  bool no_planes = false;
  bool no_joint_refinement = false;

  engine::TrackSequenceOptions resolve(const CommonOptions& common,
                                       const InputOptions& input) const;
};
void add_tracking_options(CLI::App& command, TrackingOptions& options);

/// Tracks with a progress bar and shows the sequence's warnings.
engine::Reconstruction track_with_progress(engine::Sequence& sequence,
                                           const engine::TrackSequenceOptions& options,
                                           const Console& console);

/// Frames without a pose, and the line that says so.
struct TrackingReport {
  int frames = 0;
  int posed = 0;
  bool poor = false;  ///< more than half of the frames have no pose
  std::string line;
};
TrackingReport report_tracking(const engine::Reconstruction& reconstruction, bool causal);

/// Exit status by the manual.
inline constexpr int kDone = 0;
inline constexpr int kPoorResult = 1;
inline constexpr int kBadInput = 2;
inline constexpr int kInternalError = 3;

}  // namespace planecast::app
