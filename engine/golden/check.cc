#include "engine/golden/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "engine/golden/draw_case.h"
#include "engine/golden/swap_folder.h"
#include "engine/output/atomic_file.h"
#include "engine/output/png.h"
#include "engine/sequence/image_file.h"
#include "engine/user_error.h"

namespace planecast::engine {

namespace fs = std::filesystem;

namespace {

constexpr const char* kStatusNames[] = {"same", "differs", "missing", "failed"};

std::vector<const GoldenCase*> chosen_cases(const GoldenSuite& suite,
                                            const std::vector<std::string>& only) {
  std::vector<const GoldenCase*> cases;
  for (const std::string& name : only) {
    const bool known = std::ranges::any_of(
        suite.cases, [&name](const GoldenCase& golden_case) { return golden_case.name == name; });
    if (!known) throw UserError("--only " + name + ": golden.yaml has no such case");
  }
  for (const GoldenCase& golden_case : suite.cases) {
    const bool wanted = only.empty() || std::ranges::find(only, golden_case.name) != only.end();
    if (wanted) cases.push_back(&golden_case);
  }
  return cases;
}

fs::path cache_of(const GoldenOptions& options) { return options.output / "sequences"; }

void write_picture(const cv::Mat& picture, const fs::path& file) {
  make_folder(file.parent_path());
  write_png(picture, file);
}

bool is_within(const ImageDifference& difference, const GoldenTolerance& tolerance) {
  return difference.comparable && difference.share_beyond <= tolerance.share &&
         difference.ssim >= tolerance.ssim;
}

std::string describe(const ImageDifference& difference, const GoldenTolerance& tolerance) {
  return fmt::format(
      "largest difference {} of 255, {:.3f} % of the pixels beyond {} (allowed {:.3f} %), SSIM "
      "{:.4f} (at least {:.4f})",
      difference.max_difference, 100.0 * difference.share_beyond, tolerance.channel,
      100.0 * tolerance.share, difference.ssim, tolerance.ssim);
}

void compare(const GoldenSuite& suite, const GoldenCase& golden_case, GoldenResult& result) {
  const fs::path file = suite.expected_folder() / golden_picture(golden_case, result.frame);
  std::error_code ignored;
  if (!fs::exists(file, ignored)) {
    result.status = GoldenStatus::kMissing;
    result.message = fmt::format("{}: missing; `planecast golden update {}` writes it",
                                 file.string(), suite.folder.string());
    return;
  }
  try {
    result.expected = read_color_image(file);
  } catch (const UserError& error) {
    result.status = GoldenStatus::kFailed;
    result.message = error.what();
    return;
  }
  const GoldenTolerance& tolerance = golden_case.tolerance;
  result.difference = compare_images(result.expected, result.actual, tolerance.channel);
  if (!result.difference.comparable) {
    result.status = GoldenStatus::kDiffers;
    result.message =
        fmt::format("{} is {}x{}, the picture drawn {}x{}", file.string(), result.expected.cols,
                    result.expected.rows, result.actual.cols, result.actual.rows);
    return;
  }
  if (!is_within(result.difference, tolerance)) result.status = GoldenStatus::kDiffers;
  result.message = describe(result.difference, tolerance);
}

/// Adds the pictures of a case, or one result that says why there are none.
void check_case(const GoldenSuite& suite, const GoldenCase& golden_case,
                const GoldenOptions& options, const Progress& progress,
                std::vector<GoldenResult>& results) {
  GoldenPictures pictures;
  try {
    pictures = draw_golden_case(golden_case, cache_of(options), options.threads, progress);
  } catch (const UserError& error) {
    results.push_back({golden_case.name, -1, GoldenStatus::kFailed, error.what(), {}, {}, {}});
    return;
  }
  for (const auto& [frame, picture] : pictures) {
    GoldenResult result{golden_case.name, frame, GoldenStatus::kSame, "", {}, {}, picture};
    write_picture(picture, options.output / "actual" / golden_picture(golden_case, frame));
    compare(suite, golden_case, result);
    results.push_back(std::move(result));
  }
}

/// Copies what is expected of the cases that are not drawn anew.
void keep_other_cases(const GoldenSuite& suite, const std::vector<const GoldenCase*>& drawn,
                      const fs::path& folder) {
  for (const GoldenCase& golden_case : suite.cases) {
    const bool is_drawn = std::ranges::find(drawn, &golden_case) != drawn.end();
    const fs::path old = suite.expected_folder() / golden_case.name;
    std::error_code error;
    if (is_drawn || !fs::exists(old, error)) continue;
    fs::copy(old, folder / golden_case.name, fs::copy_options::recursive, error);
    if (error) throw UserError(old.string() + ": cannot be copied: " + error.message());
  }
}

}  // namespace

std::string GoldenResult::title() const {
  return frame < 0 ? case_name : fmt::format("{}/{:06}", case_name, frame);
}

std::vector<GoldenResult> check_golden_suite(const GoldenSuite& suite, const GoldenOptions& options,
                                             const GoldenWatch& watch) {
  const auto cases = chosen_cases(suite, options.only);
  make_folder(options.output);
  std::vector<GoldenResult> results;
  for (const GoldenCase* golden_case : cases) {
    check_case(suite, *golden_case, options, watch(golden_case->name), results);
  }
  return results;
}

int update_golden_suite(const GoldenSuite& suite, const GoldenOptions& options,
                        const GoldenWatch& watch) {
  const auto cases = chosen_cases(suite, options.only);
  make_folder(options.output);
  const fs::path folder = temporary_path(suite.expected_folder());
  std::error_code ignored;
  fs::remove_all(folder, ignored);
  make_folder(folder);
  int pictures = 0;
  for (const GoldenCase* golden_case : cases) {
    for (const auto& [frame, picture] : draw_golden_case(
             *golden_case, cache_of(options), options.threads, watch(golden_case->name))) {
      write_picture(picture, folder / golden_picture(*golden_case, frame));
      ++pictures;
    }
  }
  keep_other_cases(suite, cases, folder);
  replace_folder(folder, suite.expected_folder());
  return pictures;
}

nlohmann::ordered_json to_json(const std::vector<GoldenResult>& results) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const GoldenResult& result : results) {
    nlohmann::ordered_json entry;
    entry["case"] = result.case_name;
    if (result.frame >= 0) entry["frame"] = result.frame;
    entry["status"] = kStatusNames[static_cast<int>(result.status)];
    entry["message"] = result.message;
    if (result.difference.comparable) {
      entry["max_difference"] = result.difference.max_difference;
      entry["mean_difference"] = result.difference.mean_difference;
      entry["share_beyond"] = result.difference.share_beyond;
      entry["ssim"] = result.difference.ssim;
    }
    json.push_back(std::move(entry));
  }
  return json;
}

}  // namespace planecast::engine
