#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace planecast::bench {

/// Figures of one method on one setting, over its trials.
struct Row {
  std::string setting;
  std::string method;
  double f = 0.0;             ///< mean F-score of the inlier labels
  double error = 0.0;         ///< median; pixels, or degrees for planes
  double offset_cm = 0.0;     ///< median, planes only
  double milliseconds = 0.0;  ///< median
};

struct Table {
  std::string title;
  std::string note;
  std::string error_unit;  ///< "px" or "deg"
  std::vector<Row> rows;
};

/// Writes `name`.md with all tables, `name`.csv and, per table, a plot of F over its settings as
/// `name`_<k>.svg, which the Markdown shows.
void write_report(const std::filesystem::path& folder, const std::string& name,
                  const std::string& introduction, const std::vector<Table>& tables);

}  // namespace planecast::bench
