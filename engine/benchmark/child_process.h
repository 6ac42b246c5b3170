#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace planecast::engine {

/// What became of a child process and what it took.
struct ChildResult {
  int exit_status = -1;         ///< -1: it did not end by itself
  int signal = 0;               ///< that ended it; 0: none
  double seconds = 0.0;         ///< of the wall clock
  double cpu_seconds = 0.0;     ///< of all its threads, user and system
  double peak_mb = 0.0;         ///< largest resident size, 2^20 bytes
  std::string last_error_line;  ///< of what it wrote to stderr
};

/// Runs this executable with other arguments and waits for it; stdout and stderr go to `log`.
/// Throws UserError when the log cannot be written or no process can be started.
ChildResult run_this_executable(const std::vector<std::string>& arguments,
                                const std::filesystem::path& log);

}  // namespace planecast::engine
