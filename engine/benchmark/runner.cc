#include "engine/benchmark/runner.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "engine/benchmark/child_process.h"
#include "engine/benchmark/measure.h"
#include "engine/cancel.h"
#include "engine/output/atomic_file.h"
#include "engine/output/json_text.h"
#include "engine/program.h"
#include "engine/sequence/frame_options.h"
#include "engine/sequence/made_sequence.h"
#include "engine/user_error.h"

namespace planecast::engine {

namespace fs = std::filesystem;

namespace {

constexpr const char* kRunFile = "run.json";

std::vector<std::string> synth_arguments(const SynthOptions& synth, const fs::path& folder) {
  std::vector<std::string> arguments = {"synth",    synth.name,
                                        "-o",       folder.string(),
                                        "--width",  std::to_string(synth.width),
                                        "--height", std::to_string(synth.height),
                                        "--fps",    fmt::format("{}", synth.fps),
                                        "--seed",   std::to_string(synth.seed),
                                        "--quiet"};
  if (synth.frames > 0) {
    arguments.insert(arguments.end(), {"--count", std::to_string(synth.frames)});
  }
  if (synth.lens != "none") arguments.insert(arguments.end(), {"--lens", synth.lens});
  if (synth.trouble != "none") {
    arguments.insert(arguments.end(), {"--trouble", synth.trouble});
  }
  if (!synth.effects) arguments.emplace_back("--no-effects");
  return arguments;
}

std::string reason_of(const ChildResult& child) {
  if (child.signal != 0) return fmt::format("ended by signal {}", child.signal);
  if (!child.last_error_line.empty()) return child.last_error_line;
  return fmt::format("exit status {}", child.exit_status);
}

std::string describe(const BenchmarkRow& row) {
  std::string text = fmt::format("{} {} {} seed {}: {}", row.run.sequence->name, row.run.mode,
                                 row.run.variant->name, row.run.seed, row.status);
  for (const char* key : {"ate_cm", "f_5", "drift_px", "seconds"}) {
    const auto found = row.metrics.find(key);
    if (found == row.metrics.end()) continue;
    const MetricInfo info = metric_info(key);
    text += fmt::format(", {} {:.{}f}", info.label, found->second, info.decimals);
  }
  return text;
}

}  // namespace

BenchmarkRunner::BenchmarkRunner(const BenchmarkConfig& config, BenchmarkOptions options,
                                 Report report)
    : config_(config),
      options_(std::move(options)),
      report_(std::move(report)),
      program_(program_key()) {
  if (options_.cache.empty()) options_.cache = options_.output / "sequences";
  for (const std::string& name : options_.only) {
    const bool known = std::any_of(config_.sequences.begin(), config_.sequences.end(),
                                   [&name](const BenchmarkSequence& s) { return s.name == name; });
    if (!known) throw UserError("--only " + name + ": the configuration has no such sequence");
  }
}

fs::path BenchmarkRunner::folder_of(const BenchmarkSequence& sequence) const {
  return sequence.synth ? options_.cache / made_sequence_name(*sequence.synth) : sequence.path;
}

bool BenchmarkRunner::is_present(const BenchmarkSequence& sequence) const {
  std::error_code ignored;
  return sequence.synth.has_value() || fs::exists(sequence.path, ignored);
}

BenchmarkRun BenchmarkRunner::make_run(const BenchmarkSequence& sequence, const std::string& mode,
                                       const BenchmarkVariant& variant, std::uint64_t seed) const {
  BenchmarkRun run{&sequence, &variant, mode, seed, {}, {}};
  run.folder = options_.output / "runs" /
               folder_name(fmt::format("{}_{}_{}_{}", sequence.name, mode, variant.name, seed));
  run.arguments = {
      "track",  folder_of(sequence).string(), "-o",           run.folder.string(), "--mode", mode,
      "--seed", std::to_string(seed),         "--no-progress"};
  for (const auto& [option, value] :
       {std::pair{"--camera", sequence.camera}, std::pair{"--frames", sequence.frames},
        std::pair{"--size", sequence.size}}) {
    if (!value.empty()) run.arguments.insert(run.arguments.end(), {option, value});
  }
  for (const auto* more : {&config_.options, &variant.options}) {
    run.arguments.insert(run.arguments.end(), more->begin(), more->end());
  }
  return run;
}

std::vector<BenchmarkRun> BenchmarkRunner::plan() const {
  const auto contains = [](const std::vector<std::string>& list, const std::string& name) {
    return list.empty() || std::find(list.begin(), list.end(), name) != list.end();
  };
  std::vector<BenchmarkRun> runs;
  for (const BenchmarkSequence& sequence : config_.sequences) {
    if (!contains(options_.only, sequence.name)) continue;
    for (const std::string& mode : sequence.modes) {
      for (const BenchmarkVariant& variant : config_.variants) {
        if (!contains(sequence.variants, variant.name) || !contains(variant.modes, mode)) continue;
        for (const std::uint64_t seed : options_.seeds.empty() ? config_.seeds : options_.seeds) {
          runs.push_back(make_run(sequence, mode, variant, seed));
        }
      }
    }
  }
  return runs;
}

std::string BenchmarkRunner::make_sequence(const BenchmarkSequence& sequence) {
  const fs::path folder = folder_of(sequence);
  std::error_code ignored;
  if (fs::exists(folder / "planes.json", ignored)) return "";  // written last
  make_folder(folder);
  const ChildResult child =
      run_this_executable(synth_arguments(*sequence.synth, folder),
                          options_.cache / (made_sequence_name(*sequence.synth) + ".log"));
  return child.exit_status == 0 ? "" : "failed: synth: " + reason_of(child);
}

const SequenceTruth* BenchmarkRunner::truth_of(const BenchmarkSequence& sequence) {
  const auto known = truths_.find(sequence.name);
  if (known != truths_.end()) return known->second.get();
  std::unique_ptr<SequenceTruth>& truth = truths_[sequence.name];
  try {
    SequenceOptions options;
    options.camera = sequence.camera;
    if (!sequence.frames.empty()) parse_frames(sequence.frames, options);
    if (!sequence.size.empty()) options.size = parse_size(sequence.size);
    truth = std::make_unique<SequenceTruth>(
        read_sequence_truth(folder_of(sequence), options, sequence.groundtruth));
  } catch (const UserError&) {
    truth.reset();  // without truth: counts and times alone
  }
  return truth.get();
}

BenchmarkRow BenchmarkRunner::execute(const BenchmarkRun& run) {
  BenchmarkRow row{run, "", {}};
  if (!is_present(*run.sequence)) {
    row.status = "not present";
    return row;
  }
  if (options_.resume) {
    if (auto kept = read_row(run)) return *kept;
  }
  if (run.sequence->synth) row.status = make_sequence(*run.sequence);
  if (!row.status.empty()) return row;
  std::error_code ignored;
  fs::remove(run.folder / kRunFile, ignored);
  make_folder(run.folder);
  const ChildResult child = run_this_executable(run.arguments, run.folder / "log.txt");
  if (child.exit_status != 0 && child.exit_status != 1) {
    row.status = "failed: " + reason_of(child);
    return row;
  }
  try {
    row.metrics = measure_reconstruction(run.folder, truth_of(*run.sequence));
    row.status = child.exit_status == 0 ? "ok" : "poor";
  } catch (const UserError& error) {
    row.status = std::string("failed: ") + error.what();
    return row;
  }
  row.metrics["seconds"] = child.seconds;
  row.metrics["cpu_seconds"] = child.cpu_seconds;
  row.metrics["peak_mb"] = child.peak_mb;
  if (row.metrics["frames"] > 0.0) {
    row.metrics["ms_per_frame"] = 1000.0 * child.seconds / row.metrics["frames"];
  }
  write_row(row);
  return row;
}

void BenchmarkRunner::write_row(const BenchmarkRow& row) const {
  nlohmann::ordered_json json;
  json["program"] = program_;
  json["arguments"] = row.run.arguments;
  json["status"] = row.status;
  json["metrics"] = row.metrics;
  write_file(row.run.folder / kRunFile, json_text(json) + "\n");
}

std::optional<BenchmarkRow> BenchmarkRunner::read_row(const BenchmarkRun& run) const {
  std::error_code ignored;
  const fs::path file = run.folder / kRunFile;
  if (!fs::exists(file, ignored)) return std::nullopt;
  const nlohmann::json json = nlohmann::json::parse(read_file(file), nullptr, false);
  if (!json.is_object() || json.value("program", "") != program_ ||
      json.value("arguments", nlohmann::json()) != run.arguments) {
    return std::nullopt;
  }
  BenchmarkRow row{run, json.value("status", ""), {}};
  const nlohmann::json metrics = json.value("metrics", nlohmann::json::object());
  for (const auto& [key, value] : metrics.items()) {
    if (value.is_number()) row.metrics[key] = value.get<double>();
  }
  return row;
}

std::vector<BenchmarkRow> BenchmarkRunner::run() {
  make_folder(options_.output);
  make_folder(options_.cache);
  const std::vector<BenchmarkRun> runs = plan();
  std::vector<BenchmarkRow> rows;
  for (const BenchmarkRun& run : runs) {
    BenchmarkRow row = execute(run);
    if (cancel_requested()) break;  // the run was ended with this process
    rows.push_back(std::move(row));
    if (report_) {
      report_(static_cast<int>(rows.size()), static_cast<int>(runs.size()), describe(rows.back()));
    }
  }
  return rows;
}

}  // namespace planecast::engine
