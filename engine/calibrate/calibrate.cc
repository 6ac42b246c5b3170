#include "engine/calibrate/calibrate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <opencv2/calib3d.hpp>

#include "engine/calibrate/view_selection.h"
#include "engine/cancel.h"
#include "engine/sequence/camera_file.h"
#include "engine/user_error.h"

namespace planecast::engine {
namespace {

constexpr std::size_t kLeastViews = 3;
constexpr std::size_t kFewViews = 10;
constexpr double kPoorCoverage = 0.6;
constexpr double kLittleSlantDeg = 20.0;
constexpr double kLargeRmsPx = 1.0;
constexpr double kUncertainFocal = 0.005;
/// A view is dropped where its error is so many times the median's.
constexpr double kOutlierFactor = 3.0;

/// OpenCV's solution of one set of views.
struct Solution {
  cv::Mat1d matrix = cv::Mat1d::eye(3, 3);
  cv::Mat1d distortion;
  std::vector<cv::Mat> rotations;
  std::vector<cv::Mat> translations;
  std::optional<double> focal_uncertainty;
};

struct Corners {
  std::vector<std::vector<cv::Point3f>> board;
  std::vector<std::vector<cv::Point2f>> image;
};

Corners corners_of(const std::vector<CalibrationView>& views) {
  Corners corners;
  for (const CalibrationView& view : views) {
    corners.board.push_back(view.corners.board);
    corners.image.push_back(view.corners.image);
  }
  return corners;
}

Solution solve(const std::vector<CalibrationView>& views, cv::Size size, slam::LensModel lens) {
  const Corners corners = corners_of(views);
  Solution solution;
  try {
    if (lens == slam::LensModel::kFisheye) {
      cv::fisheye::calibrate(corners.board, corners.image, size, solution.matrix,
                             solution.distortion, solution.rotations, solution.translations,
                             cv::fisheye::CALIB_RECOMPUTE_EXTRINSIC | cv::fisheye::CALIB_FIX_SKEW);
      return solution;
    }
    cv::Mat1d deviations;
    cv::calibrateCamera(corners.board, corners.image, size, solution.matrix, solution.distortion,
                        solution.rotations, solution.translations, deviations, cv::noArray(),
                        cv::noArray());
    solution.focal_uncertainty = deviations(0) / solution.matrix(0, 0);
    return solution;
  } catch (const cv::Exception&) {
    throw UserError(
        "no camera explains these views of the board: record it from more sides, and "
        "check its number of squares");
  }
}

double view_rms(const CalibrationView& view, const Solution& solution, std::size_t index,
                slam::LensModel lens) {
  std::vector<cv::Point2f> projected;
  if (lens == slam::LensModel::kFisheye) {
    cv::fisheye::projectPoints(view.corners.board, projected, solution.rotations[index],
                               solution.translations[index], solution.matrix, solution.distortion);
  } else {
    cv::projectPoints(view.corners.board, solution.rotations[index], solution.translations[index],
                      solution.matrix, solution.distortion, projected);
  }
  const double error = cv::norm(projected, view.corners.image, cv::NORM_L2SQR);
  return std::sqrt(error / static_cast<double>(projected.size()));
}

double slant_deg(const cv::Mat& rotation) {
  cv::Mat1d matrix;
  cv::Rodrigues(rotation, matrix);
  return std::acos(std::min(std::abs(matrix(2, 2)), 1.0)) * 180.0 / CV_PI;
}

void judge_views(const Solution& solution, slam::LensModel lens,
                 std::vector<CalibrationView>& views) {
  for (std::size_t i = 0; i < views.size(); ++i) {
    views[i].rms_px = view_rms(views[i], solution, i, lens);
    views[i].slant_deg = slant_deg(solution.rotations[i]);
  }
}

/// Drops the views that do not fit the others; returns how many.
int drop_outliers(std::vector<CalibrationView>& views) {
  std::vector<double> errors;
  for (const CalibrationView& view : views) errors.push_back(view.rms_px);
  std::ranges::nth_element(errors, errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2));
  const double limit = kOutlierFactor * errors[errors.size() / 2];
  const auto fits = [limit](const CalibrationView& view) { return view.rms_px <= limit; };
  if (static_cast<std::size_t>(std::ranges::count_if(views, fits)) < kLeastViews) return 0;
  return static_cast<int>(std::erase_if(views, std::not_fn(fits)));
}

double total_rms(const std::vector<CalibrationView>& views) {
  double sum = 0.0;
  double count = 0.0;
  for (const CalibrationView& view : views) {
    const auto corners = static_cast<double>(view.corners.image.size());
    sum += view.rms_px * view.rms_px * corners;
    count += corners;
  }
  return std::sqrt(sum / count);
}

slam::Camera to_camera(const Solution& solution, cv::Size size, slam::LensModel lens) {
  slam::Camera camera;
  camera.lens = lens;
  camera.width = size.width;
  camera.height = size.height;
  camera.fx = solution.matrix(0, 0);
  camera.fy = solution.matrix(1, 1);
  camera.cx = solution.matrix(0, 2);
  camera.cy = solution.matrix(1, 2);
  const std::size_t used = lens == slam::LensModel::kFisheye ? 4 : 5;
  for (std::size_t i = 0; i < used; ++i) {
    camera.distortion[i] = solution.distortion(static_cast<int>(i));
  }
  return camera;
}

std::vector<std::string> find_faults(const Calibration& result) {
  std::vector<std::string> warnings;
  if (result.views.size() < kFewViews) {
    warnings.push_back(fmt::format(
        "only {} views of the board: {} or more, from different sides, make it reliable",
        result.views.size(), kFewViews));
  }
  if (result.coverage < kPoorCoverage) {
    warnings.push_back(
        fmt::format("the board covers only {:.0f} % of the picture: move it into "
                    "the edges and corners too",
                    100.0 * result.coverage));
  }
  const auto slanted = std::ranges::count_if(
      result.views, [](const CalibrationView& view) { return view.slant_deg >= kLittleSlantDeg; });
  if (4 * slanted < static_cast<std::ptrdiff_t>(result.views.size())) {
    warnings.push_back(
        "the board is seen almost from the front alone: tilt it by 30 to 45 degrees to all sides");
  }
  if (result.rms_px > kLargeRmsPx) {
    warnings.push_back(fmt::format(
        "the corners are {:.2f} px off on average: is the board flat, the picture sharp, {}?",
        result.rms_px,
        result.camera.lens == slam::LensModel::kPinhole ? "the lens no fisheye (--model fisheye)"
                                                        : "the lens a fisheye"));
  }
  if (result.focal_uncertainty.value_or(0.0) > kUncertainFocal) {
    warnings.push_back(fmt::format("the focal length is known to {:.1f} % only: record more views",
                                   100.0 * *result.focal_uncertainty));
  }
  return warnings;
}

}  // namespace

Calibration calibrate_from_views(std::vector<CalibrationView> views, cv::Size image_size,
                                 const CalibrateOptions& options) {
  if (views.size() < kLeastViews) {
    throw UserError(
        fmt::format("the board is seen in {} frames, and at least {} are needed: check "
                    "its kind and its number of squares",
                    views.size(), kLeastViews));
  }
  Calibration result;
  Solution solution = solve(views, image_size, options.lens);
  judge_views(solution, options.lens, views);
  result.rejected = drop_outliers(views);
  if (result.rejected > 0) {
    solution = solve(views, image_size, options.lens);
    judge_views(solution, options.lens, views);
  }
  result.camera = to_camera(solution, image_size, options.lens);
  result.focal_uncertainty = solution.focal_uncertainty;
  result.rms_px = total_rms(views);
  std::vector<BoardView> corners;
  for (const CalibrationView& view : views) corners.push_back(view.corners);
  result.coverage = corner_coverage(corners, image_size);
  result.views = std::move(views);
  result.warnings = find_faults(result);
  return result;
}

Calibration calibrate_camera(Sequence& recording, const BoardSpec& board,
                             const CalibrateOptions& options, const Progress& progress) {
  const BoardDetector detector(board);
  const int total = recording.end_frame() - recording.first_frame();
  const int count = std::min(total, options.most_frames);
  std::vector<CalibrationView> found;
  cv::Size size;
  for (int i = 0; i < count; ++i) {
    throw_if_cancelled();
    const int frame =
        recording.first_frame() + static_cast<int>(static_cast<long long>(i) * total / count);
    const cv::Mat image = recording.read(frame).image;
    size = image.size();
    if (auto corners = detector.find(image))
      found.push_back({frame, std::move(*corners), 0.0, 0.0});
    if (progress) progress(i + 1, count);
  }
  std::vector<BoardView> corners;
  for (const CalibrationView& view : found) corners.push_back(view.corners);
  std::vector<CalibrationView> chosen;
  for (const int index : select_views(corners, size, options.most_views)) {
    chosen.push_back(found[static_cast<std::size_t>(index)]);
  }
  try {
    Calibration result = calibrate_from_views(std::move(chosen), size, options);
    result.frames = count;
    result.found = static_cast<int>(found.size());
    return result;
  } catch (const UserError& error) {
    throw UserError(recording.path().string() + ": " + error.what());
  }
}

std::string format_table(const Calibration& calibration) {
  const slam::Camera& camera = calibration.camera;
  const std::size_t used = camera.lens == slam::LensModel::kFisheye ? 4 : 5;
  std::string text = fmt::format(
      "board found       {} of {} frames, {} views used, {} dropped\n"
      "reprojection RMS  {:.3f} px\n"
      "coverage          {:.0f} % of the picture\n"
      "focal length      {:.2f} x {:.2f} px",
      calibration.found, calibration.frames, calibration.views.size(), calibration.rejected,
      calibration.rms_px, 100.0 * calibration.coverage, camera.fx, camera.fy);
  if (calibration.focal_uncertainty) {
    text += fmt::format(" (+- {:.2f} %)", 100.0 * *calibration.focal_uncertainty);
  }
  return text +
         fmt::format("\ncentre            {:.2f} {:.2f} px\ndistortion        {:.5f}", camera.cx,
                     camera.cy,
                     fmt::join(camera.distortion.begin(), camera.distortion.begin() + used, " "));
}

nlohmann::ordered_json to_json(const Calibration& calibration) {
  nlohmann::ordered_json json;
  json["frames"] = calibration.frames;
  json["found"] = calibration.found;
  json["views"] = calibration.views.size();
  json["rejected"] = calibration.rejected;
  json["rms_px"] = calibration.rms_px;
  json["coverage"] = calibration.coverage;
  if (calibration.focal_uncertainty) json["focal_uncertainty"] = *calibration.focal_uncertainty;
  json.update(camera_json(calibration.camera));
  json["warnings"] = calibration.warnings;
  return json;
}

}  // namespace planecast::engine
