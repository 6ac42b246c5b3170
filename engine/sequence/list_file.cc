#include "engine/sequence/list_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>
#include <tuple>

#include "engine/user_error.h"

namespace planecast::engine {

namespace fs = std::filesystem;

std::vector<ListLine> read_list_lines(const fs::path& file) {
  std::error_code ignored;
  std::ifstream in;
  if (fs::is_regular_file(file, ignored)) in.open(file);
  if (!in.is_open()) throw UserError(file.string() + ": cannot be opened");
  std::vector<ListLine> lines;
  std::string text;
  for (int number = 1; std::getline(in, text); ++number) {
    text.erase(std::min(text.find('#'), text.size()));
    std::istringstream words(text);
    ListLine line{number, {}};
    for (std::string word; words >> word;) line.fields.push_back(word);
    if (!line.fields.empty()) lines.push_back(std::move(line));
  }
  return lines;
}

std::optional<double> parse_number(const std::string& field) {
  double value = 0.0;
  const char* begin = field.data() + (field.starts_with('+') ? 1 : 0);
  const char* end = field.data() + field.size();
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (error != std::errc() || stop != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::vector<TimedFile> read_timed_files(const fs::path& list) {
  std::vector<std::pair<TimedFile, int>> numbered;
  for (const ListLine& line : read_list_lines(list)) {
    const auto timestamp = parse_number(line.fields[0]);
    if (!timestamp || line.fields.size() != 2) {
      throw UserError(
          fmt::format("{}:{}: expected 'timestamp filename'", list.string(), line.number));
    }
    numbered.push_back({{*timestamp, list.parent_path() / line.fields[1]}, line.number});
  }
  std::stable_sort(numbered.begin(), numbered.end(), [](const auto& a, const auto& b) {
    return a.first.timestamp < b.first.timestamp;
  });
  std::vector<TimedFile> files;
  for (const auto& [file, number] : numbered) {
    if (!files.empty() && files.back().timestamp == file.timestamp) {
      throw UserError(fmt::format("{}:{}: the timestamp is there twice", list.string(), number));
    }
    files.push_back(file);
  }
  return files;
}

std::vector<int> pair_by_time(const std::vector<double>& a, const std::vector<double>& b,
                              double max_difference_s) {
  std::vector<std::tuple<double, int, int>> candidates;
  std::vector<int> order(b.size());
  for (std::size_t j = 0; j < b.size(); ++j) order[j] = static_cast<int>(j);
  std::sort(order.begin(), order.end(),
            [&b](int i, int j) { return std::tie(b[i], i) < std::tie(b[j], j); });
  for (std::size_t i = 0; i < a.size(); ++i) {
    auto first = std::lower_bound(order.begin(), order.end(), a[i] - max_difference_s,
                                  [&b](int j, double time) { return b[j] < time; });
    for (; first != order.end() && b[*first] <= a[i] + max_difference_s; ++first) {
      candidates.emplace_back(std::abs(a[i] - b[*first]), static_cast<int>(i), *first);
    }
  }
  std::sort(candidates.begin(), candidates.end());
  std::vector<int> partner(a.size(), -1);
  std::vector<char> used(b.size(), 0);
  for (const auto& [difference, i, j] : candidates) {
    if (partner[i] >= 0 || used[j] != 0) continue;
    partner[i] = j;
    used[j] = 1;
  }
  return partner;
}

}  // namespace planecast::engine
