#include "test/bench/fitting/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>

namespace planecast::bench {

namespace {

bool is_about_planes(const Table& table) { return table.error_unit == "deg"; }

std::string markdown_of(const Table& table) {
  const bool planes = is_about_planes(table);
  std::string text = fmt::format("## {}\n\n{}\n\n", table.title, table.note);
  text += planes ? "| setting | method | F | angle deg | offset cm | ms |\n"
                   "| --- | --- | ---: | ---: | ---: | ---: |\n"
                 : "| setting | method | F | error px | ms |\n| --- | --- | ---: | ---: | ---: |\n";
  for (const Row& row : table.rows) {
    text += planes ? fmt::format("| {} | {} | {:.3f} | {:.2f} | {:.2f} | {:.2f} |\n", row.setting,
                                 row.method, row.f, row.error, row.offset_cm, row.milliseconds)
                   : fmt::format("| {} | {} | {:.3f} | {:.3f} | {:.2f} |\n", row.setting,
                                 row.method, row.f, row.error, row.milliseconds);
  }
  return text;
}

std::vector<std::string> settings_of(const Table& table) {
  std::vector<std::string> settings;
  for (const Row& row : table.rows) {
    if (std::find(settings.begin(), settings.end(), row.setting) == settings.end()) {
      settings.push_back(row.setting);
    }
  }
  return settings;
}

/// One line per method over the settings; F from the lowest shown tenth to 1.
std::string plot_of(const Table& table) {
  constexpr double kLeft = 50.0, kTop = 20.0, kStep = 90.0, kHigh = 260.0;
  const char* const colours[] = {"#c0392b", "#2c7fb8", "#7f8c8d", "#8e44ad", "#27ae60"};
  const std::vector<std::string> settings = settings_of(table);
  double low = 1.0;
  for (const Row& row : table.rows) low = std::min(low, row.f);
  low = std::max(0.0, static_cast<int>(low * 10.0) / 10.0);
  if (low > 0.9) low = 0.9;
  const double width = kLeft + kStep * static_cast<double>(settings.size()) + 160.0;
  const auto y_of = [&](double f) { return kTop + kHigh * (1.0 - f) / (1.0 - low); };
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{:.0f}\" height=\"{:.0f}\" "
      "font-family=\"sans-serif\" font-size=\"11\">\n<rect width=\"100%\" height=\"100%\" "
      "fill=\"white\"/>\n",
      width, kTop + kHigh + 90.0);
  for (int i = 0; i <= 5; ++i) {
    const double f = low + (1.0 - low) * i / 5.0;
    svg += fmt::format(
        "<line x1=\"{0}\" x2=\"{1:.0f}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\" stroke=\"#ddd\"/>"
        "<text x=\"{3}\" y=\"{4:.1f}\">{5:.2f}</text>\n",
        kLeft, width - 160.0, y_of(f), 10, y_of(f) + 4.0, f);
  }
  for (std::size_t i = 0; i < settings.size(); ++i) {
    const double x = kLeft + kStep * (static_cast<double>(i) + 0.3);
    svg += fmt::format("<text transform=\"translate({:.1f} {:.1f}) rotate(25)\">{}</text>\n", x,
                       kTop + kHigh + 18.0, settings[i]);
  }
  std::map<std::string, std::string> lines;
  std::vector<std::string> methods;
  for (const Row& row : table.rows) {
    if (!lines.contains(row.method)) methods.push_back(row.method);
    const auto place = std::find(settings.begin(), settings.end(), row.setting);
    const double x = kLeft + kStep * (static_cast<double>(place - settings.begin()) + 0.3);
    lines[row.method] += fmt::format("{:.1f},{:.1f} ", x, y_of(std::max(row.f, low)));
  }
  for (std::size_t m = 0; m < methods.size(); ++m) {
    const char* colour = colours[m % std::size(colours)];
    svg += fmt::format(
        "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"/>"
        "<text x=\"{:.0f}\" y=\"{:.0f}\" fill=\"{}\">{}</text>\n",
        lines[methods[m]], colour, width - 150.0, kTop + 20.0 * static_cast<double>(m + 1), colour,
        methods[m]);
  }
  return svg + "</svg>\n";
}

}  // namespace

void write_report(const std::filesystem::path& folder, const std::string& name,
                  const std::string& introduction, const std::vector<Table>& tables) {
  std::filesystem::create_directories(folder);
  std::ofstream markdown(folder / (name + ".md"));
  std::ofstream csv(folder / (name + ".csv"));
  markdown << introduction;
  csv << "table,setting,method,f,error,error_unit,offset_cm,ms\n";
  for (std::size_t k = 0; k < tables.size(); ++k) {
    const std::string plot = fmt::format("{}_{}.svg", name, k + 1);
    markdown << '\n'
             << markdown_of(tables[k]) << fmt::format("\n![{}]({})\n", tables[k].title, plot);
    std::ofstream(folder / plot) << plot_of(tables[k]);
    for (const Row& row : tables[k].rows) {
      csv << fmt::format("\"{}\",\"{}\",\"{}\",{:.4f},{:.4f},{},{:.4f},{:.4f}\n", tables[k].title,
                         row.setting, row.method, row.f, row.error, tables[k].error_unit,
                         row.offset_cm, row.milliseconds);
    }
  }
}

}  // namespace planecast::bench
