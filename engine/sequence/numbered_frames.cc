#include "engine/sequence/numbered_frames.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace planecast::engine {

namespace fs = std::filesystem;

std::vector<NumberedFile> numbered_files(const fs::path& folder, const std::string& suffix) {
  static const std::string kPrefix = "frame-";
  std::vector<NumberedFile> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(kPrefix) || !name.ends_with(suffix) ||
        name.size() <= kPrefix.size() + suffix.size()) {
      continue;
    }
    int number = 0;
    const char* begin = name.data() + kPrefix.size();
    const char* end = name.data() + name.size() - suffix.size();
    const auto [stop, error] = std::from_chars(begin, end, number);
    if (error == std::errc() && stop == end && number >= 0) files.push_back({number, entry.path()});
  }
  std::sort(files.begin(), files.end(), [](const NumberedFile& a, const NumberedFile& b) {
    return a.number != b.number ? a.number < b.number : a.file < b.file;
  });
  return files;
}

double nominal_time(double number, double fps) { return std::round(number / fps * 1e6) / 1e6; }

}  // namespace planecast::engine
