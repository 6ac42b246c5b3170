#pragma once

#include <string>

#include "engine/output/report.h"

namespace planecast::engine {

/// The parts of report.html that are tables and words. Each is empty where there is nothing to say.

std::string warnings_html(const Reconstruction& reconstruction, const ReportInput& input);
/// The few numbers that say how the run went, large.
std::string key_figures_html(const Reconstruction& reconstruction, const ReportInput& input);
std::string summary_html(const Reconstruction& reconstruction, const ReportInput& input);
std::string planes_html(const Reconstruction& reconstruction);
/// Holds times of computing.
std::string timings_html(const Reconstruction& reconstruction);
/// Command, versions and the files beside the report.
std::string reproduce_html(const ReportInput& input);

}  // namespace planecast::engine
