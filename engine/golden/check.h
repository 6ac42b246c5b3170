#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "engine/evaluate/image_compare.h"
#include "engine/golden/suite.h"
#include "engine/pipeline/track_sequence.h"

namespace planecast::engine {

enum class GoldenStatus {
  kSame,     ///< within the tolerance
  kDiffers,  ///< beyond it, or of another size
  kMissing,  ///< there is no expected picture
  kFailed,   ///< the case could not be drawn, or the expected picture not be read
};

/// What became of one picture; of a whole case where it could not be drawn (frame -1).
struct GoldenResult {
  std::string case_name;
  int frame = -1;
  GoldenStatus status = GoldenStatus::kSame;
  std::string message;  ///< one line for the user, without the case's name
  ImageDifference difference;
  cv::Mat expected;  ///< BGR; empty where there is none
  cv::Mat actual;    ///< BGR; empty where there is none

  std::string title() const;  ///< "robot/000120"
};

struct GoldenOptions {
  std::filesystem::path output;   ///< report.html, actual/ and made sequences
  std::vector<std::string> only;  ///< names of cases; empty: all
  int threads = 2;                ///< changes no result
};

/// Called when a case's work begins, with its name; returns where its progress goes.
using GoldenWatch = std::function<Progress(const std::string& case_name)>;

/// Draws every case and compares its pictures with the expected ones; what was drawn is written to
/// actual/CASE/NNNNNN.png below the output. A case that fails does not end the check. Throws
/// UserError for an unknown name in `only` and an output that cannot be written.
std::vector<GoldenResult> check_golden_suite(const GoldenSuite& suite, const GoldenOptions& options,
                                             const GoldenWatch& watch);

/// Draws every case (of `only`) and then takes the pictures for expected in one step: either all of
/// them are new or, where something fails, none. Cases that the suite has no more are dropped.
/// Returns the number of pictures. Throws UserError.
int update_golden_suite(const GoldenSuite& suite, const GoldenOptions& options,
                        const GoldenWatch& watch);

nlohmann::ordered_json to_json(const std::vector<GoldenResult>& results);

}  // namespace planecast::engine
