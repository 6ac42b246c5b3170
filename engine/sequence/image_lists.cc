#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string_view>

#include "engine/sequence/image_file.h"
#include "engine/sequence/image_list_sequence.h"
#include "engine/sequence/list_file.h"
#include "engine/sequence/numbered_frames.h"
#include "engine/user_error.h"

namespace planecast::engine {

namespace fs = std::filesystem;

namespace {

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

/// The run of digits at `at` without leading zeros; moves `at` behind it.
std::string_view take_number(std::string_view text, std::size_t& at) {
  while (at + 1 < text.size() && text[at] == '0' && is_digit(text[at + 1])) ++at;
  const std::size_t begin = at;
  while (at < text.size() && is_digit(text[at])) ++at;
  return text.substr(begin, at - begin);
}

std::vector<double> times_of(const std::vector<TimedFile>& files) {
  std::vector<double> times;
  for (const TimedFile& file : files) times.push_back(file.timestamp);
  return times;
}

/// Gives the frames the nearest of the files that `list` names; the number of pairs.
int attach(const fs::path& list, std::vector<FrameFiles>& frames, fs::path FrameFiles::*member) {
  const std::vector<TimedFile> files = read_timed_files(list);
  std::vector<double> frame_times;
  for (const FrameFiles& frame : frames) frame_times.push_back(frame.timestamp);
  const std::vector<int> partner = pair_by_time(frame_times, times_of(files));
  int pairs = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (partner[i] < 0) continue;
    frames[i].*member = files[static_cast<std::size_t>(partner[i])].file;
    ++pairs;
  }
  return pairs;
}

/// In the order of time, whatever the list's; `file` named the frames.
void sort_by_time(const fs::path& file, std::vector<FrameFiles>& frames) {
  if (frames.empty()) throw UserError(file.string() + ": lists no images");
  std::stable_sort(frames.begin(), frames.end(), [](const FrameFiles& a, const FrameFiles& b) {
    return a.timestamp < b.timestamp;
  });
  const auto twice = std::adjacent_find(
      frames.begin(), frames.end(),
      [](const FrameFiles& a, const FrameFiles& b) { return a.timestamp == b.timestamp; });
  if (twice != frames.end()) {
    throw UserError(
        fmt::format("{}: the timestamp {} is there twice", file.string(), twice->timestamp));
  }
}

ImageList list_tum(const fs::path& folder) {
  ImageList list;
  list.path = folder;
  for (const TimedFile& file : read_timed_files(folder / "rgb.txt")) {
    list.frames.push_back({file.timestamp, file.file, {}, {}});
  }
  if (list.frames.empty()) throw UserError((folder / "rgb.txt").string() + ": lists no images");
  for (const auto& [name, member] :
       {std::pair{"depth.txt", &FrameFiles::depth}, std::pair{"mask.txt", &FrameFiles::mask}}) {
    if (!fs::exists(folder / name)) continue;
    if (attach(folder / name, list.frames, member) == 0) {
      list.warnings.push_back(
          fmt::format("{}: nothing in it is within 20 ms of an image", (folder / name).string()));
    }
  }
  return list;
}

/// ICL-NUIM's lines are `time depth time rgb`; TUM's tools write `time rgb time depth`.
ImageList list_associations(const fs::path& folder) {
  const fs::path file = folder / "associations.txt";
  ImageList list;
  list.path = folder;
  bool depth_first = false;
  for (const ListLine& line : read_list_lines(file)) {
    const auto time_a = parse_number(line.fields[0]);
    const auto time_b = line.fields.size() == 4 ? parse_number(line.fields[2]) : std::nullopt;
    if (!time_a || !time_b) {
      throw UserError(
          fmt::format("{}:{}: expected 'time file time file'", file.string(), line.number));
    }
    depth_first = line.fields[1].find("depth") != std::string::npos;
    FrameFiles frame;
    frame.timestamp = depth_first ? *time_b : *time_a;
    frame.image = folder / line.fields[depth_first ? 3 : 1];
    frame.depth = folder / line.fields[depth_first ? 1 : 3];
    list.frames.push_back(frame);
  }
  sort_by_time(file, list.frames);
  // ICL-NUIM numbers its frames instead of timing them.
  const bool numbered =
      list.frames.size() > 1 && list.frames[1].timestamp - list.frames[0].timestamp >= 1.0;
  list.has_timestamps = !numbered;
  if (numbered && depth_first) list.camera_file = "icl-nuim";
  return list;
}

/// `timestamp [ns],filename` of the ASL format.
ImageList list_euroc(const fs::path& folder, const fs::path& camera_folder) {
  const fs::path file = camera_folder / "data.csv";
  ImageList list;
  list.path = folder;
  for (const ListLine& line : read_list_lines(file)) {
    std::string text;
    for (const std::string& field : line.fields) text += field;
    const std::size_t comma = std::min(text.find(','), text.size());
    const auto nanoseconds = parse_number(text.substr(0, comma));
    if (!nanoseconds || comma + 1 >= text.size()) {
      throw UserError(
          fmt::format("{}:{}: expected 'nanoseconds,filename'", file.string(), line.number));
    }
    list.frames.push_back(
        {*nanoseconds * 1e-9, camera_folder / "data" / text.substr(comma + 1), {}, {}});
  }
  sort_by_time(file, list.frames);
  if (fs::exists(camera_folder / "sensor.yaml")) list.camera_file = camera_folder / "sensor.yaml";
  return list;
}

/// 7-Scenes: frame-000000.color.png with .depth.png beside it.
ImageList list_seven_scenes(const fs::path& folder, const std::vector<NumberedFile>& images) {
  ImageList list;
  list.path = folder;
  list.has_timestamps = false;
  list.camera_file = "7scenes";
  for (const NumberedFile& image : images) {
    std::string depth = image.file.filename().string();
    depth.replace(depth.rfind(".color."), 7, ".depth.");
    FrameFiles frame{static_cast<double>(image.number), image.file, {}, {}};
    if (fs::exists(folder / depth)) frame.depth = folder / depth;
    list.frames.push_back(frame);
  }
  return list;
}

ImageList list_folder(const fs::path& folder) {
  const std::vector<NumberedFile> seven_scenes = numbered_files(folder, ".color.png");
  if (!seven_scenes.empty()) return list_seven_scenes(folder, seven_scenes);
  ImageList list;
  list.path = folder;
  list.has_timestamps = false;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file() && has_image_suffix(entry.path())) {
      list.frames.push_back({0.0, entry.path(), {}, {}});
    }
  }
  std::sort(list.frames.begin(), list.frames.end(), [](const FrameFiles& a, const FrameFiles& b) {
    return natural_less(a.image.filename().string(), b.image.filename().string());
  });
  for (std::size_t i = 0; i < list.frames.size(); ++i) {
    list.frames[i].timestamp = static_cast<double>(i);
  }
  if (list.frames.empty()) {
    throw UserError(folder.string() + ": holds neither rgb.txt nor images (png, jpg, bmp, tif)");
  }
  return list;
}

}  // namespace

bool natural_less(const std::string& a, const std::string& b) {
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < a.size() && j < b.size()) {
    if (is_digit(a[i]) && is_digit(b[j])) {
      const std::string_view x = take_number(a, i);
      const std::string_view y = take_number(b, j);
      if (x.size() != y.size()) return x.size() < y.size();
      if (x != y) return x < y;
    } else {
      if (a[i] != b[j]) return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[j]);
      ++i;
      ++j;
    }
  }
  if (i < a.size() || j < b.size()) return i >= a.size();
  return a < b;  // equal but for leading zeros
}

ImageList list_images(const fs::path& path) {
  if (!fs::is_directory(path)) {
    ImageList list;
    list.path = path;
    list.has_timestamps = false;
    list.frames.push_back({0.0, path, {}, {}});
    return list;
  }
  ImageList list;
  if (fs::exists(path / "rgb.txt")) {
    list = list_tum(path);
  } else if (fs::exists(path / "associations.txt")) {
    list = list_associations(path);
  } else if (fs::exists(path / "mav0" / "cam0" / "data.csv")) {
    list = list_euroc(path, path / "mav0" / "cam0");
  } else if (fs::exists(path / "cam0" / "data.csv")) {
    list = list_euroc(path, path / "cam0");
  } else {
    list = list_folder(path);
  }
  if (fs::exists(path / "camera.yaml")) list.camera_file = path / "camera.yaml";
  return list;
}

}  // namespace planecast::engine
