#include "engine/benchmark/published.h"

#include <fmt/format.h>

#include <algorithm>

namespace planecast::engine {

std::vector<const PublishedColumn*> published_columns(
    const BenchmarkConfig& config, const std::string& metric, const std::string& mode,
    const std::vector<const ResultGroup*>& groups) {
  std::vector<const PublishedColumn*> columns;
  for (const PublishedColumn& column : config.published) {
    const auto figures = column.figures.find(mode);
    if (column.metric != metric || figures == column.figures.end()) continue;
    const bool speaks = std::any_of(groups.begin(), groups.end(), [&](const ResultGroup* group) {
      return figures->second.count(group->sequence->name) > 0;
    });
    if (speaks) columns.push_back(&column);
  }
  return columns;
}

std::string published_note(const std::vector<const PublishedColumn*>& columns) {
  if (columns.empty()) return "";
  std::string note =
      "\nColumns with a name in *italics* are not measured here; they are as printed:\n\n";
  for (const PublishedColumn* column : columns) {
    note += fmt::format("- *{}*: {}\n", column->name, column->source);
  }
  return note;
}

std::string published_figure(const PublishedColumn& column, const std::string& mode,
                             const std::string& row) {
  const auto figures = column.figures.find(mode);
  if (figures == column.figures.end()) return "-";
  const auto figure = figures->second.find(row);
  return figure == figures->second.end() ? "-" : figure->second;
}

}  // namespace planecast::engine
