#include "engine/golden/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "engine/assets.h"
#include "engine/output/atomic_file.h"
#include "engine/output/png.h"
#include "engine/output/report_svg.h"
#include "engine/user_error.h"

namespace planecast::engine {
namespace {

constexpr double kGain = 16.0;
constexpr int kQuality = 90;
constexpr const char* kTitleMark = "{{title}}";
constexpr const char* kDataMark = "{{data}}";

std::string embed(const cv::Mat& picture, bool lossless) {
  if (picture.empty()) return "";
  return lossless ? png_data_uri(picture) : jpeg_data_uri(picture, kQuality);
}

nlohmann::ordered_json page_data(const std::vector<GoldenResult>& results) {
  nlohmann::ordered_json data = to_json(results);
  for (std::size_t i = 0; i < results.size(); ++i) {
    const GoldenResult& result = results[i];
    const bool lossless = result.status != GoldenStatus::kSame;
    data[i]["title"] = result.title();
    data[i]["expected"] = embed(result.expected, lossless);
    data[i]["actual"] = embed(result.actual, lossless);
    data[i]["difference"] =
        embed(difference_picture(result.expected, result.actual, kGain), lossless);
  }
  return data;
}

void replace_mark(std::string& page, const std::string& mark, const std::string& text) {
  const std::size_t at = page.find(mark);
  if (at == std::string::npos) throw UserError("golden/report.html: has no " + mark);
  page.replace(at, mark.size(), text);
}

/// JSON inside a <script> element: nothing in it may end the element.
std::string script_text(const nlohmann::ordered_json& json) {
  std::string text = json.dump();
  for (std::size_t at = 0; (at = text.find("</", at)) != std::string::npos; at += 3) {
    text.replace(at, 2, "<\\/");
  }
  return text;
}

int count(const std::vector<GoldenResult>& results, const std::vector<GoldenStatus>& statuses) {
  return static_cast<int>(std::ranges::count_if(results, [&statuses](const GoldenResult& result) {
    return std::ranges::find(statuses, result.status) != statuses.end();
  }));
}

std::string junit_test(const GoldenResult& result) {
  const std::string name =
      result.frame < 0 ? std::string("draw") : fmt::format("frame {}", result.frame);
  std::string xml = fmt::format("    <testcase classname=\"{}\" name=\"{}\"",
                                escape_html(result.case_name), name);
  if (result.status == GoldenStatus::kSame) return xml + "/>\n";
  const char* element = result.status == GoldenStatus::kFailed ? "error" : "failure";
  return xml + fmt::format(">\n      <{0} message=\"{1}\"/>\n    </testcase>\n", element,
                           escape_html(result.message));
}

std::string junit_suite(const std::string& name, const std::vector<GoldenResult>& results) {
  std::string xml = fmt::format(
      "  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"{}\">\n", escape_html(name),
      results.size(), count(results, {GoldenStatus::kDiffers, GoldenStatus::kMissing}),
      count(results, {GoldenStatus::kFailed}));
  for (const GoldenResult& result : results) xml += junit_test(result);
  return xml + "  </testsuite>\n";
}

}  // namespace

void write_golden_report(const std::vector<GoldenResult>& results, const std::string& title,
                         const std::filesystem::path& file) {
  std::string page = read_file(asset("golden/report.html"));
  replace_mark(page, kTitleMark, escape_html(title));
  replace_mark(page, kTitleMark, escape_html(title));
  replace_mark(page, kDataMark, script_text(page_data(results)));
  write_file(file, page);
}

void write_junit(const std::vector<GoldenResult>& results, const std::filesystem::path& file) {
  std::string suites;
  for (auto begin = results.begin(); begin != results.end();) {
    const auto end = std::find_if(begin, results.end(), [&begin](const GoldenResult& result) {
      return result.case_name != begin->case_name;
    });
    suites += junit_suite(begin->case_name, {begin, end});
    begin = end;
  }
  write_file(file, fmt::format("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
                               "<testsuites name=\"planecast golden\" tests=\"{}\" failures=\"{}\" "
                               "errors=\"{}\">\n{}</testsuites>\n",
                               results.size(),
                               count(results, {GoldenStatus::kDiffers, GoldenStatus::kMissing}),
                               count(results, {GoldenStatus::kFailed}), suites));
}

}  // namespace planecast::engine
