#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace planecast::engine {

/// A line of a list in TUM format, split at blanks; comments (from '#') and empty lines are left
/// out wherever they stand.
struct ListLine {
  int number = 0;  ///< 1-based
  std::vector<std::string> fields;
};

/// Throws UserError when the file cannot be read.
std::vector<ListLine> read_list_lines(const std::filesystem::path& file);

/// A finite number that fills the whole field, whatever the locale.
std::optional<double> parse_number(const std::string& field);

struct TimedFile {
  double timestamp = 0.0;  ///< seconds
  std::filesystem::path file;
};

/// `timestamp filename` lines, in the order of their times; the names are relative to the list's
/// folder. Throws UserError naming the line that is malformed or repeats a time.
std::vector<TimedFile> read_timed_files(const std::filesystem::path& list);

/// For each time of `a` the index of its partner in `b` or -1: greedy by time difference, each
/// partner once, at most `max_difference_s` apart.
std::vector<int> pair_by_time(const std::vector<double>& a, const std::vector<double>& b,
                              double max_difference_s = 0.02);

}  // namespace planecast::engine
