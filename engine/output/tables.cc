#include "engine/output/tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <nlohmann/json.hpp>
#include <string_view>

#include "engine/output/atomic_file.h"
#include "engine/output/csv.h"
#include "engine/output/trajectory.h"
#include "engine/user_error.h"

namespace planecast::engine {
namespace {

constexpr std::string_view kFramesHeader = "index,timestamp,state,reason,inliers";
constexpr std::string_view kTimeUnit = " ms";
constexpr const char* kTracking = "Tracking";
constexpr const char* kSegmentation = "Instance Planar Segmentation";
constexpr std::array<const char*, 11> kPaperRows = {kTracking,
                                                    "Local Mapping",
                                                    kSegmentation,
                                                    "System (Mono) Initialization",
                                                    "Point-Plane Map Initialization",
                                                    "Non-Planar Map Point Culling",
                                                    "New Plane Detection",
                                                    "Plane Merging/Expanding",
                                                    "Plane Re-estimation",
                                                    "Point-Plane Refinement",
                                                    "Local BA"};

std::vector<std::string> split_csv(std::string_view line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quoted && c == '"' && i + 1 < line.size() && line[i + 1] == '"') {
      fields.back() += line[++i];
    } else if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  return fields;
}

template <typename T>
bool parse_number(const std::string& text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && !text.empty();
}

/// The first line of `rest`, which moves behind it.
std::string_view take_line(std::string_view& rest) {
  const std::size_t end = std::min(rest.find('\n'), rest.size());
  std::string_view line = rest.substr(0, end);
  rest.remove_prefix(std::min(end + 1, rest.size()));
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

bool parse_frame(std::string_view line, FrameRecord& frame) {
  const std::vector<std::string> fields = split_csv(line);
  if (fields.size() != 5) return false;
  frame.state = fields[2];
  frame.reason = fields[3];
  return parse_number(fields[0], frame.index) && parse_number(fields[1], frame.timestamp) &&
         parse_number(fields[4], frame.inliers);
}

void add_new_names(std::vector<std::string>& names, const StageTimes& times) {
  for (const auto& [name, ms] : times) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
}

std::vector<std::string> frame_stage_names(const Reconstruction& reconstruction) {
  std::vector<std::string> names;
  for (const StageTimes& times : reconstruction.frame_times) add_new_names(names, times);
  return names;
}

std::vector<double> samples_of(const Reconstruction& reconstruction, const std::string& name) {
  const auto mapping = reconstruction.mapping_times.find(name);
  if (mapping != reconstruction.mapping_times.end()) return mapping->second;
  std::vector<double> samples;
  for (const StageTimes& times : reconstruction.frame_times) {
    for (const auto& [stage, ms] : times) {
      if (stage == name) samples.push_back(ms);
    }
  }
  return samples;
}

std::vector<double> tracking_samples(const Reconstruction& reconstruction) {
  std::vector<double> samples = samples_of(reconstruction, kTracking);
  if (!samples.empty()) return samples;
  for (const StageTimes& times : reconstruction.frame_times) {
    if (times.empty()) continue;
    double sum = 0.0;
    for (const auto& [stage, ms] : times) sum += stage == kSegmentation ? 0.0 : ms;
    samples.push_back(sum);
  }
  return samples;
}

}  // namespace

void write_frames_csv(const std::vector<FrameRecord>& frames, const std::filesystem::path& path) {
  std::string text = std::string(kFramesHeader) + "\n";
  for (const FrameRecord& frame : frames) {
    text += fmt::format("{},{},{},{},{}\n", frame.index, format_timestamp(frame.timestamp),
                        csv_field(frame.state), csv_field(frame.reason), frame.inliers);
  }
  write_file(path, text);
}

std::vector<FrameRecord> read_frames_csv(const std::filesystem::path& path) {
  const std::string text = read_file(path);
  std::vector<FrameRecord> frames;
  std::string_view rest = text;
  for (int line_number = 1; !rest.empty(); ++line_number) {
    const std::string_view line = take_line(rest);
    if (line_number == 1) {
      if (line != kFramesHeader) {
        throw UserError(
            fmt::format("{}:1: the header is not \"{}\"", path.string(), kFramesHeader));
      }
    } else if (FrameRecord frame; parse_frame(line, frame)) {
      frames.push_back(std::move(frame));
    } else {
      throw UserError(fmt::format("{}:{}: is not a frame's record", path.string(), line_number));
    }
  }
  return frames;
}

void write_times_csv(const Reconstruction& reconstruction, const std::filesystem::path& path) {
  const std::vector<std::string> names = frame_stage_names(reconstruction);
  std::string text = "index";
  for (const std::string& name : names) text += "," + csv_field(name + std::string(kTimeUnit));
  text += '\n';
  for (std::size_t i = 0; i < reconstruction.frame_times.size(); ++i) {
    const bool known = i < reconstruction.frames.size();
    text += fmt::format("{}", known ? reconstruction.frames[i].index : static_cast<int>(i));
    const StageTimes& times = reconstruction.frame_times[i];
    for (const std::string& name : names) {
      const auto stage = std::find_if(times.begin(), times.end(),
                                      [&name](const auto& entry) { return entry.first == name; });
      text += stage == times.end() ? "," : fmt::format(",{:.3f}", stage->second);
    }
    text += '\n';
  }
  write_file(path, text);
}

std::vector<StageTimes> read_times_csv(const std::filesystem::path& path) {
  const std::string text = read_file(path);
  std::string_view rest = text;
  std::vector<std::string> names = split_csv(take_line(rest));
  for (std::string& name : names) {
    if (name.ends_with(kTimeUnit)) name.resize(name.size() - kTimeUnit.size());
  }
  std::vector<StageTimes> frames;
  for (int line_number = 2; !rest.empty(); ++line_number) {
    const std::vector<std::string> fields = split_csv(take_line(rest));
    StageTimes& times = frames.emplace_back();
    bool good = fields.size() == names.size();
    for (std::size_t i = 1; good && i < fields.size(); ++i) {
      double ms = 0.0;
      if (fields[i].empty()) continue;
      good = parse_number(fields[i], ms);
      times.emplace_back(names[i], ms);
    }
    if (!good) {
      throw UserError(fmt::format("{}:{}: is not a frame's times", path.string(), line_number));
    }
  }
  return frames;
}

std::vector<std::string> paper_timing_names() { return {kPaperRows.begin(), kPaperRows.end()}; }

std::vector<TimingRow> timing_rows(const Reconstruction& reconstruction) {
  if (!reconstruction.timings.empty()) return reconstruction.timings;
  std::vector<TimingRow> rows;
  for (const char* name : kPaperRows) {
    rows.push_back({name, statistics_of(name == kTracking ? tracking_samples(reconstruction)
                                                          : samples_of(reconstruction, name))});
  }
  std::vector<std::string> names;
  for (const auto& [name, samples] : reconstruction.mapping_times) names.push_back(name);
  for (const StageTimes& times : reconstruction.frame_times) add_new_names(names, times);
  for (const std::string& name : names) {
    const bool listed = std::any_of(rows.begin(), rows.end(),
                                    [&name](const TimingRow& row) { return row.name == name; });
    if (!listed) rows.push_back({name, statistics_of(samples_of(reconstruction, name))});
  }
  return rows;
}

void write_timings_json(const Reconstruction& reconstruction, const std::filesystem::path& path) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const TimingRow& row : timing_rows(reconstruction)) {
    nlohmann::ordered_json json;
    json["name"] = row.name;
    json["count"] = row.ms.count;
    json["mean"] = row.ms.mean;
    json["median"] = row.ms.median;
    json["p95"] = row.ms.p95;
    rows.push_back(std::move(json));
  }
  nlohmann::ordered_json json;
  json["unit"] = "ms";
  json["rows"] = std::move(rows);
  write_file(path, json.dump(1) + "\n");
}

std::vector<TimingRow> read_timings_json(const std::filesystem::path& path) {
  std::vector<TimingRow> rows;
  try {
    const nlohmann::json document = nlohmann::json::parse(read_file(path));
    for (const auto& json : document.at("rows")) {
      TimingRow& row = rows.emplace_back();
      row.name = json.at("name").get<std::string>();
      row.ms.count = json.at("count").get<int>();
      row.ms.mean = json.at("mean").get<double>();
      row.ms.median = json.at("median").get<double>();
      row.ms.p95 = json.at("p95").get<double>();
    }
  } catch (const nlohmann::json::exception&) {
    throw UserError(path.string() + ": is not a table of timings");
  }
  return rows;
}

}  // namespace planecast::engine
