#pragma once

#include <chrono>
#include <string>

namespace planecast::app {

enum class Verbosity { kQuiet, kNormal, kVerbose };

/// Keeps the libraries' own chatter (OpenCV, Ceres' glog, FFmpeg) away from the user's terminal.
void silence_libraries();

/// What a command tells while it works. Results go to stdout, everything else to stderr.
class Console {
 public:
  Console(Verbosity verbosity, bool show_progress)
      : verbosity_(verbosity), show_progress_(show_progress && verbosity != Verbosity::kQuiet) {}

  void result(const std::string& line) const;   ///< always
  void info(const std::string& line) const;     ///< not when quiet
  void detail(const std::string& line) const;   ///< only when verbose
  void warning(const std::string& line) const;  ///< not when quiet
  void error(const std::string& line) const;    ///< always; for faults that do not end the command
  bool show_progress() const { return show_progress_; }
  bool verbose() const { return verbosity_ == Verbosity::kVerbose; }

 private:
  Verbosity verbosity_;
  bool show_progress_;
};

/// Progress of one long step on stderr: on a terminal a bar with frames per second and the time
/// left, otherwise a line every 10 %.
class ProgressBar {
 public:
  ProgressBar(const Console& console, std::string label);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void update(int done, int total);
  /// Ends the line; called by the destructor too.
  void finish();

 private:
  void draw_bar(int done, int total, double seconds);

  std::string label_;
  bool enabled_;
  bool terminal_;
  bool open_line_ = false;
  int last_tenth_ = 0;
  double last_drawn_s_ = -1.0;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace planecast::app
