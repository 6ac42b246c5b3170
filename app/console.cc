#include "app/console.h"

#include <glog/logging.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <opencv2/core/utils/logger.hpp>
#include <utility>

extern "C" {
#include <libavutil/log.h>
}

namespace planecast::app {
namespace {

constexpr int kBarWidth = 28;
constexpr double kRedrawSeconds = 0.1;

std::string format_time_left(double seconds) {
  const int whole = static_cast<int>(seconds + 0.5);
  char text[32];
  std::snprintf(text, sizeof(text), "%d:%02d", whole / 60, whole % 60);
  return text;
}

}  // namespace

void silence_libraries() {
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  av_log_set_level(AV_LOG_QUIET);
  FLAGS_minloglevel = google::GLOG_FATAL;
  spdlog::set_level(spdlog::level::off);
}

void Console::result(const std::string& line) const { std::printf("%s\n", line.c_str()); }

void Console::info(const std::string& line) const {
  if (verbosity_ != Verbosity::kQuiet) std::fprintf(stderr, "%s\n", line.c_str());
}

void Console::detail(const std::string& line) const {
  if (verbosity_ == Verbosity::kVerbose) std::fprintf(stderr, "%s\n", line.c_str());
}

void Console::warning(const std::string& line) const {
  if (verbosity_ != Verbosity::kQuiet) std::fprintf(stderr, "warning: %s\n", line.c_str());
}

void Console::error(const std::string& line) const {
  std::fprintf(stderr, "planecast: %s\n", line.c_str());
}

ProgressBar::ProgressBar(const Console& console, std::string label)
    : label_(std::move(label)),
      enabled_(console.show_progress()),
      terminal_(isatty(STDERR_FILENO) == 1),
      start_(std::chrono::steady_clock::now()) {}

ProgressBar::~ProgressBar() { finish(); }

void ProgressBar::update(int done, int total) {
  if (!enabled_ || total <= 0) return;
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start_;
  if (terminal_) {
    if (done < total && elapsed.count() - last_drawn_s_ < kRedrawSeconds) return;
    last_drawn_s_ = elapsed.count();
    draw_bar(done, total, elapsed.count());
    return;
  }
  const int tenth = 10 * done / total;
  if (tenth <= last_tenth_) return;
  last_tenth_ = tenth;
  std::fprintf(stderr, "%s: %d %% (%d of %d)\n", label_.c_str(), 10 * tenth, done, total);
}

void ProgressBar::draw_bar(int done, int total, double seconds) {
  const int filled = std::clamp(kBarWidth * done / total, 0, kBarWidth);
  std::string bar(static_cast<std::size_t>(filled), '#');
  bar.resize(kBarWidth, '.');
  const double per_second = seconds > 0.0 ? done / seconds : 0.0;
  const std::string left =
      per_second > 0.0 ? format_time_left((total - done) / per_second) : std::string("-:--");
  std::fprintf(stderr, "\r%-10s [%s] %d/%d  %.1f fps  %s left \033[K", label_.c_str(), bar.c_str(),
               done, total, per_second, left.c_str());
  std::fflush(stderr);
  open_line_ = true;
}

void ProgressBar::finish() {
  if (open_line_) std::fputc('\n', stderr);
  open_line_ = false;
}

}  // namespace planecast::app
