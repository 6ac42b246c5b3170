#include "app/command_line.h"

#include <ceres/version.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <opencv2/core/version.hpp>

#include "app/commands.h"
#include "engine/output/libav.h"

namespace planecast::app {
namespace {

std::string quoted(const std::string& word) {
  constexpr const char* kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./:=,+-@%";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

}  // namespace

std::string command_line() {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  std::string line;
  for (std::size_t begin = 0; begin < bytes.size();) {
    const std::size_t end = std::min(bytes.find('\0', begin), bytes.size());
    line += (line.empty() ? "" : " ") + quoted(bytes.substr(begin, end - begin));
    begin = end + 1;
  }
  return line;
}

std::vector<std::pair<std::string, std::string>> versions(const std::string& renderer) {
  return {{"Planecast", kVersion},
          {"OpenGL", renderer},
          {"OpenCV", CV_VERSION},
          {"Ceres Solver", CERES_VERSION_STRING},
          {"FFmpeg", av_version_info()}};
}

}  // namespace planecast::app
