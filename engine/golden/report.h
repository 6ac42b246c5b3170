#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/golden/check.h"

namespace planecast::engine {

/// One self-contained page: every picture as expected and as drawn with a slider between them, and
/// their difference times 16. Pictures that differ are embedded without loss, the others as JPEG.
/// Throws UserError where it cannot be written.
void write_golden_report(const std::vector<GoldenResult>& results, const std::string& title,
                         const std::filesystem::path& file);

/// JUnit's XML as CI systems read it: a test suite for each case, a test for each picture. What
/// differs or is missing is a failure, what could not be drawn an error. Throws UserError where it
/// cannot be written.
void write_junit(const std::vector<GoldenResult>& results, const std::filesystem::path& file);

}  // namespace planecast::engine
