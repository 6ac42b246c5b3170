#include "engine/benchmark/report_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <thread>

#include "engine/benchmark/result_groups.h"
#include "engine/benchmark/result_plots.h"
#include "engine/benchmark/result_tables.h"
#include "engine/output/atomic_file.h"
#include "engine/user_error.h"

namespace planecast::engine {
namespace {

/// Sequences that are not here, a line for them all.
std::string absence_note(const std::vector<ResultGroup>& groups) {
  std::vector<std::string> names;
  for (const ResultGroup& group : groups) {
    const std::string& name = group.sequence->name;
    if (!group.is_present() && std::find(names.begin(), names.end(), name) == names.end()) {
      names.push_back(name);
    }
  }
  if (names.empty()) return "";
  return fmt::format("Not present, so not run: {}.\n\n", fmt::join(names, ", "));
}

std::string failure_note(const std::vector<BenchmarkRow>& rows) {
  std::string text;
  for (const BenchmarkRow& row : rows) {
    if (row.usable() || row.status == "not present") continue;
    text += fmt::format("- {} {} {} seed {}: {}\n", row.run.sequence->name, row.run.mode,
                        row.run.variant->name, row.run.seed, row.status);
  }
  return text.empty() ? "" : "Runs that failed:\n\n" + text + "\n";
}

std::string variant_note(const BenchmarkConfig& config) {
  if (config.variants.size() < 2) return "";
  std::string text = "Variants:\n\n";
  for (const BenchmarkVariant& variant : config.variants) {
    const std::string options = fmt::format("{}", fmt::join(variant.options, " "));
    text += fmt::format("- *{}*: {}\n", variant.name,
                        options.empty() ? "as it is by default" : "`" + options + "`");
  }
  return text + "\n";
}

/// Writes the picture and returns the line that shows it; empty for an empty picture.
std::string add_plot(const std::filesystem::path& folder, const std::string& name,
                     const std::string& title, const std::string& svg) {
  if (svg.empty()) return "";
  write_file(folder / "plots" / (name + ".svg"), svg);
  return fmt::format("![{}](plots/{}.svg)\n\n", title, name);
}

std::string plots(const BenchmarkConfig& config, const std::vector<ResultGroup>& groups,
                  BenchmarkRunner& runner, const std::filesystem::path& folder) {
  const auto wants = [&config](const char* name) {
    return config.plots.empty() ||
           std::find(config.plots.begin(), config.plots.end(), name) != config.plots.end();
  };
  std::string text;
  if (wants("ate")) text += add_plot(folder, "ate", "ATE by sequence", ate_bars_svg(groups));
  if (wants("trajectories")) {
    text += add_plot(folder, "trajectories", "paths against the truth",
                     paths_svg(path_panels(config, groups, runner)));
  }
  for (const BenchmarkCurve& curve : config.curves) {
    text += add_plot(folder, curve.y + "-over-" + curve.x, curve.y + " over " + curve.x,
                     curve_svg(curve, groups));
  }
  return text.empty() ? "" : "## Plots\n\n" + text;
}

}  // namespace

std::string processor_name() {
  std::string name = "unknown processor";
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with("model name")) continue;
    const std::size_t colon = line.find(": ");
    if (colon != std::string::npos) name = line.substr(colon + 2);
    break;
  }
  return fmt::format("{}, {} threads", name, std::thread::hardware_concurrency());
}

void write_benchmark_report(const BenchmarkConfig& config, const std::vector<BenchmarkRow>& rows,
                            BenchmarkRunner& runner, const std::vector<std::string>& facts,
                            const std::filesystem::path& folder) {
  make_folder(folder / "plots");
  const std::vector<ResultGroup> groups = group_rows(rows);
  std::string text = "# " + config.title + "\n\n";
  if (!config.about.empty()) text += config.about + "\n\n";
  for (const std::string& fact : facts) text += "- " + fact + "\n";
  text += "\n" + variant_note(config) + absence_note(groups) + failure_note(rows);
  for (const std::string& name : config.tables.empty() ? benchmark_table_names() : config.tables) {
    text += benchmark_table(name, config, groups);
  }
  text += plots(config, groups, runner, folder);
  write_file(folder / "results.csv", benchmark_csv(rows));
  write_file(folder / "results.md", text);
}

}  // namespace planecast::engine
