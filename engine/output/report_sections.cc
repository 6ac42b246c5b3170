#include "engine/output/report_sections.h"

#include <fmt/format.h>

#include "engine/output/report_svg.h"
#include "engine/output/summary.h"
#include "engine/output/tables.h"

namespace planecast::engine {
namespace {

using Rows = std::vector<std::pair<std::string, std::string>>;

std::string pairs_html(const Rows& rows) {
  std::string html = "<table class=\"pairs\">\n";
  for (const auto& [name, value] : rows) {
    html += fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n", escape_html(name),
                        escape_html(value));
  }
  return html + "</table>\n";
}

std::string share_text(int part, int whole) {
  const double percent = whole > 0 ? 100.0 * part / whole : 0.0;
  return fmt::format("{} of {} ({:.1f} %)", part, whole, percent);
}

std::string figure_html(const std::string& value, const std::string& name) {
  return fmt::format("<li><b>{}</b> {}</li>", value, name);
}

}  // namespace

std::string warnings_html(const Reconstruction& reconstruction, const ReportInput& input) {
  std::string html;
  for (const auto* warnings : {&reconstruction.warnings, &input.warnings}) {
    for (const std::string& warning : *warnings) {
      html += fmt::format("<p class=\"warning\" role=\"note\">{}</p>\n", escape_html(warning));
    }
  }
  return html;
}

std::string key_figures_html(const Reconstruction& reconstruction, const ReportInput& input) {
  const Summary s = summarise(reconstruction);
  const double percent = s.frames > 0 ? 100.0 * s.localised / s.frames : 0.0;
  std::string html = "<ul class=\"figures\">";
  html += figure_html(fmt::format("{:.0f} %", percent),
                      fmt::format("of {} frames have a pose", s.frames));
  html += figure_html(std::to_string(s.planes), s.planes == 1 ? "plane" : "planes");
  html += figure_html(std::to_string(s.points), "map points");
  html +=
      figure_html(fmt::format("{:.2f} {}", s.path_length, reconstruction.metric ? "m" : "units"),
                  "of camera path");
  if (!input.objects.empty()) {
    html += figure_html(std::to_string(input.objects.size()),
                        input.objects.size() == 1 ? "object" : "objects");
  }
  return html + "</ul>\n";
}

std::string summary_html(const Reconstruction& reconstruction, const ReportInput& input) {
  const Summary s = summarise(reconstruction);
  Rows rows = input.facts;
  rows.emplace_back("Mode", reconstruction.mode);
  if (!reconstruction.segmentation.empty()) {
    rows.emplace_back("Plane masks", reconstruction.segmentation);
  }
  rows.emplace_back("Frames with a final pose", share_text(s.localised, s.frames));
  rows.emplace_back("Frames tracked as they came", share_text(s.tracked, s.frames));
  rows.emplace_back("Frames until initialised", std::to_string(s.frames_until_initialised));
  if (s.unreadable > 0) rows.emplace_back("Unreadable frames", std::to_string(s.unreadable));
  rows.emplace_back("Keyframes", std::to_string(s.keyframes));
  rows.emplace_back("Map points, of these on planes",
                    fmt::format("{}, {}", s.points, s.points_on_planes));
  rows.emplace_back("Units", reconstruction.metric ? "metres" : "the map's own: no scale is known");
  return pairs_html(rows);
}

std::string planes_html(const Reconstruction& reconstruction) {
  if (reconstruction.planes.empty()) return "";
  std::string html =
      "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"planes\"><table>\n"
      "<tr><th scope=\"col\">Plane</th><th scope=\"col\">Class</th><th scope=\"col\">Points</th>"
      "<th scope=\"col\">RMS</th><th scope=\"col\">Area</th><th scope=\"col\">Normal</th>"
      "<th scope=\"col\">Offset</th><th scope=\"col\">From frame</th>"
      "<th scope=\"col\">Merged</th></tr>\n";
  for (const PlaneRecord& plane : reconstruction.planes) {
    html += fmt::format(
        "<tr data-plane=\"{1}\"><td><i class=\"swatch\" style=\"background:{0}\"></i>{1}</td>"
        "<td>{2}</td><td>{3}</td><td>{4:.4f}</td><td>{5:.2f}</td>"
        "<td>{6:.2f} {7:.2f} {8:.2f}</td><td>{9:.3f}</td><td>{10}</td><td>{11}</td></tr>\n",
        plane_color_css(plane.id), plane.id, escape_html(plane.plane_class), plane.inliers,
        plane.rms, plane.area, plane.normal.x(), plane.normal.y(), plane.normal.z(), plane.offset,
        plane.first_frame, fmt::join(plane.merged_from, " "));
  }
  const char* unit = reconstruction.metric ? "metres" : "map units";
  return html + fmt::format(
                    "</table></div>\n<p class=\"note\">Lengths in {}. RMS: of the points' "
                    "distances to the plane.</p>\n",
                    unit);
}

std::string timings_html(const Reconstruction& reconstruction) {
  std::string rows;
  for (const TimingRow& timing : timing_rows(reconstruction)) {
    if (timing.ms.count == 0) continue;
    rows += fmt::format(
        "<tr><td>{}</td><td>{}</td><td>{:.2f}</td><td>{:.2f}</td><td>{:.2f}</td></tr>\n",
        escape_html(timing.name), timing.ms.count, timing.ms.mean, timing.ms.median, timing.ms.p95);
  }
  if (rows.empty()) return "";
  return "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"timings\"><table>\n"
         "<tr><th scope=\"col\">Stage</th><th scope=\"col\">Times run</th>"
         "<th scope=\"col\">Mean ms</th><th scope=\"col\">Median ms</th>"
         "<th scope=\"col\">95 % ms</th></tr>\n" +
         rows + "</table></div>\n";
}

std::string reproduce_html(const ReportInput& input) {
  std::string html;
  if (!input.command.empty()) {
    html += fmt::format(
        "<div class=\"command\"><pre tabindex=\"0\" id=\"command\">{}</pre>"
        "<button type=\"button\" data-copy=\"command\" hidden>Copy</button></div>\n",
        escape_html(input.command));
  }
  if (!input.versions.empty()) html += pairs_html(input.versions);
  std::string files;
  for (const std::string& link : input.links) {
    files += fmt::format("<li><a href=\"{0}\">{0}</a></li>", escape_html(link));
  }
  if (!files.empty()) html += "<ul class=\"files\">" + files + "</ul>\n";
  return html;
}

}  // namespace planecast::engine
