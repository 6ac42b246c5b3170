#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace planecast::engine {

/// Data sets that number their frames (ICL-NUIM, 7-Scenes) instead of timing them.
struct NumberedFile {
  int number = 0;
  std::filesystem::path file;
};

/// The files `frame-NUMBER` + suffix of a folder in the order of their numbers (7-Scenes).
std::vector<NumberedFile> numbered_files(const std::filesystem::path& folder,
                                         const std::string& suffix);

/// Seconds of frame `number`, with the 6 decimals that the lists of this project print.
double nominal_time(double number, double fps);

}  // namespace planecast::engine
