#include "engine/output/report.h"

#include <fmt/format.h>

#include <opencv2/imgproc.hpp>
#include <system_error>

#include "engine/output/atomic_file.h"
#include "engine/output/base64.h"
#include "engine/output/png.h"
#include "engine/output/report_charts.h"
#include "engine/output/report_data.h"
#include "engine/output/report_page.h"
#include "engine/output/report_sections.h"
#include "engine/output/report_svg.h"

namespace planecast::engine {
namespace {

constexpr int kMaxStillWidth = 960;
/// Nothing may be loaded from outside, by the browser's own guard.
constexpr const char* kPolicy =
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; "
    "img-src data: blob:; media-src blob:";

std::string still_uri(const ReportStill& still) {
  cv::Mat image = still.bgr;
  if (image.cols > kMaxStillWidth) {
    const double scale = static_cast<double>(kMaxStillWidth) / image.cols;
    cv::resize(still.bgr, image, cv::Size(), scale, scale, cv::INTER_AREA);
  }
  return jpeg_data_uri(image);
}

/// A video small enough to be carried by the page.
bool embeds_video(const ReportInput& input) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(input.video, error);
  return !error && bytes <= input.max_video_bytes;
}

std::string video_html(const ReportInput& input) {
  const std::size_t middle = input.stills.size() / 2;
  const bool has_poster = !input.stills.empty() && !input.stills[middle].bgr.empty();
  const std::string poster =
      has_poster ? fmt::format(" poster=\"{}\"", still_uri(input.stills[middle])) : "";
  return fmt::format(
      "<video id=\"video\" controls playsinline muted loop{}></video>\n"
      "<script type=\"text/plain\" id=\"video-data\">{}</script>\n",
      poster, base64(read_file(input.video)));
}

std::string stills_html(const ReportInput& input) {
  std::string html;
  for (const ReportStill& still : input.stills) {
    if (still.bgr.empty()) continue;
    html +=
        fmt::format("<figure><img alt=\"{0}\" src=\"{1}\"><figcaption>{0}</figcaption></figure>\n",
                    escape_html(still.caption), still_uri(still));
  }
  return html.empty() ? html : "<div class=\"stills\">\n" + html + "</div>\n";
}

/// One scrubber for the video, the map and the charts.
std::string scrubber_html(const Reconstruction& reconstruction) {
  if (reconstruction.frames.empty()) return "";
  return fmt::format(
      "<div class=\"scrubber\" hidden><label for=\"frame\">Frame</label>"
      "<input type=\"range\" id=\"frame\" min=\"0\" max=\"{}\" value=\"0\" step=\"1\">"
      "<output id=\"readout\" for=\"frame\"></output></div>\n",
      reconstruction.frames.size() - 1);
}

std::string map_html(const Reconstruction& reconstruction) {
  return "<div id=\"map\" class=\"map\">" + top_view_svg(reconstruction) +
         "<p class=\"note\">The map from above.</p></div>\n";
}

std::string section(const char* id, const char* heading, const std::string& content) {
  if (content.empty()) return "";
  return fmt::format(
      "<section id=\"{0}\" aria-labelledby=\"h-{0}\"><h2 id=\"h-{0}\">{1}</h2>\n{2}"
      "</section>\n",
      id, heading, content);
}

std::string head_html(const std::string& title, const std::string& style) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"{0}\">\n"
      "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n<title>{1}</title>\n"
      "<style>\n{2}</style></head>\n",
      kPolicy, title, style);
}

std::string scripts_html(const PageFiles& files, const std::string& data) {
  std::string html =
      fmt::format("<script type=\"application/json\" id=\"data\">{}</script>\n", script_json(data));
  for (const std::string* code : {&files.map_view, &files.script}) {
    if (!code->empty()) html += "<script>\n" + script_text(*code) + "</script>\n";
  }
  return html;
}

}  // namespace

void write_report(const Reconstruction& reconstruction, const ReportInput& input,
                  const std::filesystem::path& path) {
  const PageFiles files = read_page_files();
  const std::string title = escape_html(input.title);
  std::string html = head_html(title, files.style);
  html += fmt::format("<body>\n<header><p class=\"brand\">Planecast</p><h1>{}</h1>\n", title);
  html += key_figures_html(reconstruction, input) + "</header>\n<main>\n";
  html += warnings_html(reconstruction, input);
  html +=
      section("picture", "Result", embeds_video(input) ? video_html(input) : stills_html(input));
  html += scrubber_html(reconstruction);
  html += section("space", "Map", map_html(reconstruction));
  html += section("tracking", "Inliers and state",
                  inlier_chart_html(reconstruction) + state_legend_html(reconstruction));
  html += section("planes", "Planes", planes_html(reconstruction));
  html += section("summary", "Summary", summary_html(reconstruction, input));
  html += section("reproduce", "Command and versions", reproduce_html(input));
  html += fmt::format(
      "{}\n{}{}\n", kTimesBegin,
      section("times", "Time of computing",
              times_chart_html(reconstruction, input.render_times) + timings_html(reconstruction)),
      kTimesEnd);
  html += "</main>\n" + scripts_html(files, report_data_json(reconstruction, input));
  write_file(path, html + "</body></html>\n");
}

}  // namespace planecast::engine
