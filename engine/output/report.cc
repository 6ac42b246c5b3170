#include "engine/output/report.h"

#include <fmt/format.h>

#include <opencv2/imgproc.hpp>

#include "engine/output/atomic_file.h"
#include "engine/output/png.h"
#include "engine/output/report_svg.h"
#include "engine/output/summary.h"
#include "engine/output/tables.h"

namespace planecast::engine {
namespace {

constexpr int kMaxStillWidth = 960;
constexpr const char* kStyle =
    "body{font:16px/1.45 system-ui,sans-serif;margin:0 "
    "auto;max-width:60rem;padding:1rem;color:#222;"
    "background:#fff}h1{font-size:1.5rem}h2{font-size:1.15rem;margin-top:2rem;border-bottom:1px "
    "solid "
    "#ddd}table{border-collapse:collapse;width:100%;font-variant-numeric:tabular-nums}"
    "th,td{padding:.3rem .5rem;text-align:right;border-bottom:1px solid #eee}"
    "th:first-child,td:first-child{text-align:left}.scroll{overflow-x:auto}"
    "img,svg{width:100%;height:auto;background:#fafafa}figure{margin:0 0 1rem}"
    "figcaption{font-size:.9rem;color:#555}.warning{background:#fff3cd;padding:.5rem "
    ".75rem;margin:.4rem "
    "0}.swatch{display:inline-block;width:.8em;height:.8em;margin-right:.4em}";

std::string row(const std::string& name, const std::string& value) {
  return fmt::format("<tr><td>{}</td><td>{}</td></tr>\n", escape_html(name), escape_html(value));
}

std::string share_text(int part, int whole) {
  const double percent = whole > 0 ? 100.0 * part / whole : 0.0;
  return fmt::format("{} of {} ({:.1f} %)", part, whole, percent);
}

std::string summary_html(const Reconstruction& reconstruction, const ReportInput& input) {
  const Summary s = summarise(reconstruction);
  const char* unit = reconstruction.metric ? "m" : "map units";
  std::string html = "<table>\n";
  for (const auto& [name, value] : input.facts) html += row(name, value);
  html += row("Mode", reconstruction.mode);
  html += row("Segmentation", reconstruction.segmentation);
  html += row("Frames with a final pose", share_text(s.localised, s.frames));
  html += row("Frames tracked as they came", share_text(s.tracked, s.frames));
  html += row("Frames until initialised", fmt::format("{}", s.frames_until_initialised));
  if (s.unreadable > 0) html += row("Unreadable frames", fmt::format("{}", s.unreadable));
  html += row("Keyframes", fmt::format("{}", s.keyframes));
  html +=
      row("Map points, of these on planes", fmt::format("{}, {}", s.points, s.points_on_planes));
  html += row("Planes", fmt::format("{}", s.planes));
  html += row("Length of the camera's path", fmt::format("{:.3f} {}", s.path_length, unit));
  return html + "</table>\n";
}

std::string warnings_html(const Reconstruction& reconstruction, const ReportInput& input) {
  std::string html;
  for (const auto* warnings : {&reconstruction.warnings, &input.warnings}) {
    for (const std::string& warning : *warnings) {
      html += fmt::format("<p class=\"warning\">{}</p>\n", escape_html(warning));
    }
  }
  return html;
}

std::string links_html(const ReportInput& input) {
  std::string html;
  for (const std::string& link : input.links) {
    html += fmt::format("{}<a href=\"{}\">{}</a>", html.empty() ? "<p>" : " &middot; ",
                        escape_html(link), escape_html(link));
  }
  return html.empty() ? html : html + "</p>\n";
}

std::string stills_html(const ReportInput& input) {
  std::string html;
  for (const ReportStill& still : input.stills) {
    if (still.bgr.empty()) continue;
    cv::Mat image = still.bgr;
    if (image.cols > kMaxStillWidth) {
      const double scale = static_cast<double>(kMaxStillWidth) / image.cols;
      cv::resize(still.bgr, image, cv::Size(), scale, scale, cv::INTER_AREA);
    }
    html +=
        fmt::format("<figure><img alt=\"{0}\" src=\"{1}\"><figcaption>{0}</figcaption></figure>\n",
                    escape_html(still.caption), jpeg_data_uri(image));
  }
  return html;
}

std::string planes_html(const Reconstruction& reconstruction) {
  std::string html = fmt::format(
      "<div class=\"scroll\"><table>\n<tr><th>Plane</th><th>Class</th><th>Points</th><th>RMS</th>"
      "<th>Area</th><th>Normal</th><th>Offset</th><th>First frame</th><th>Merged</th></tr>\n");
  for (const PlaneRecord& plane : reconstruction.planes) {
    html += fmt::format(
        "<tr><td><span class=\"swatch\" "
        "style=\"background:{}\"></span>{}</td><td>{}</td><td>{}</td>"
        "<td>{:.4f}</td><td>{:.2f}</td><td>{:.2f} {:.2f} {:.2f}</td><td>{:.3f}</td><td>{}</td>"
        "<td>{}</td></tr>\n",
        plane_color_css(plane.id), plane.id, escape_html(plane.plane_class), plane.inliers,
        plane.rms, plane.area, plane.normal.x(), plane.normal.y(), plane.normal.z(), plane.offset,
        plane.first_frame, fmt::join(plane.merged_from, " "));
  }
  return html + "</table></div>\n";
}

std::string timings_html(const Reconstruction& reconstruction) {
  std::string html =
      "<div class=\"scroll\"><table>\n<tr><th>Stage</th><th>Times run</th><th>Mean ms</th>"
      "<th>Median ms</th><th>95 % ms</th></tr>\n";
  for (const TimingRow& timing : timing_rows(reconstruction)) {
    if (timing.ms.count == 0) continue;
    html += fmt::format(
        "<tr><td>{}</td><td>{}</td><td>{:.2f}</td><td>{:.2f}</td><td>{:.2f}</td></tr>\n",
        escape_html(timing.name), timing.ms.count, timing.ms.mean, timing.ms.median, timing.ms.p95);
  }
  return html + "</table></div>\n";
}

std::string section(const std::string& heading, const std::string& content) {
  return content.empty() ? "" : fmt::format("<h2>{}</h2>\n{}", heading, content);
}

}  // namespace

void write_report(const Reconstruction& reconstruction, const ReportInput& input,
                  const std::filesystem::path& path) {
  const std::string title = escape_html(input.title);
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<meta name=\"viewport\" "
      "content=\"width=device-width,initial-scale=1\">\n<title>{0}</title>\n<style>{1}</style></"
      "head>\n"
      "<body>\n<h1>{0}</h1>\n",
      title, kStyle);
  html += warnings_html(reconstruction, input);
  html += links_html(input);
  html += section("Summary", summary_html(reconstruction, input));
  html += section("Stills", stills_html(input));
  html += section("Map from above", top_view_svg(reconstruction));
  html += section("Inliers by frame (red: no pose)", inlier_chart_svg(reconstruction));
  html += section("Planes", planes_html(reconstruction));
  html += section("Timings", timings_html(reconstruction));
  write_file(path, html + "</body></html>\n");
}

}  // namespace planecast::engine
