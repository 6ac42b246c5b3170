#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/benchmark/config.h"
#include "engine/benchmark/metrics.h"
#include "engine/evaluate/truth.h"

namespace planecast::engine {

struct BenchmarkOptions {
  std::filesystem::path output;      ///< runs, tables and plots
  std::filesystem::path cache;       ///< made sequences; empty: below the output
  std::vector<std::string> only;     ///< names of sequences; empty: all
  std::vector<std::uint64_t> seeds;  ///< instead of the configuration's; empty: those
  bool resume = false;               ///< keeps runs that were complete with the same arguments
};

/// One run of `track`.
struct BenchmarkRun {
  const BenchmarkSequence* sequence = nullptr;
  const BenchmarkVariant* variant = nullptr;
  std::string mode;
  std::uint64_t seed = 1;
  std::filesystem::path folder;
  std::vector<std::string> arguments;
};

/// A row of the results. `status`: "ok", "poor" (more than half of the frames without a pose), "not
/// present" (the sequence is not there) or "failed: " and the reason.
struct BenchmarkRow {
  BenchmarkRun run;
  std::string status;
  Metrics metrics;

  bool usable() const { return status == "ok" || status == "poor"; }
};

/// Runs a configuration, one child process at a time.
class BenchmarkRunner {
 public:
  /// Called with a line for the user after each step.
  using Report = std::function<void(int done, int total, const std::string& line)>;

  BenchmarkRunner(const BenchmarkConfig& config, BenchmarkOptions options, Report report);

  /// Every run of the configuration, in its order. A run that fails is a row that says so. Throws
  /// UserError for a name in `only` that the configuration has not and for folders that cannot be
  /// written.
  std::vector<BenchmarkRow> run();

  /// Where a sequence is, made or on disk.
  std::filesystem::path folder_of(const BenchmarkSequence& sequence) const;
  /// The truth of a sequence, null where it has none; read once.
  const SequenceTruth* truth_of(const BenchmarkSequence& sequence);

 private:
  std::vector<BenchmarkRun> plan() const;
  BenchmarkRun make_run(const BenchmarkSequence& sequence, const std::string& mode,
                        const BenchmarkVariant& variant, std::uint64_t seed) const;
  bool is_present(const BenchmarkSequence& sequence) const;
  std::string make_sequence(const BenchmarkSequence& sequence);
  BenchmarkRow execute(const BenchmarkRun& run);
  std::optional<BenchmarkRow> read_row(const BenchmarkRun& run) const;
  void write_row(const BenchmarkRow& row) const;

  const BenchmarkConfig& config_;
  BenchmarkOptions options_;
  Report report_;
  std::string program_;  ///< in the file of each run: a resumed benchmark mixes no builds
  std::map<std::string, std::unique_ptr<SequenceTruth>> truths_;
};

}  // namespace planecast::engine
