#pragma once

#include <chrono>
#include <map>
#include <string>
#include <utility>

#include "render/gl/functions.h"

namespace planecast::render {

/// Where a frame's time goes, for benchmarks. Waits for the driver at the end of each pass, which
/// costs time itself, so it is off unless asked for. Times never change what is drawn.
class PassClock {
 public:
  PassClock(const Gl& gl, bool running) : gl_(&gl), running_(running) {}

  void start() {
    if (running_) last_ = Clock::now();
  }
  void end_of(const char* pass) {
    if (!running_) return;
    gl_->Finish();
    const auto now = Clock::now();
    ms_[pass] += std::chrono::duration<double, std::milli>(now - last_).count();
    last_ = now;
  }
  /// Milliseconds by pass, of all frames since the last call.
  std::map<std::string, double> take() { return std::exchange(ms_, {}); }

 private:
  using Clock = std::chrono::steady_clock;
  const Gl* gl_;
  bool running_;
  Clock::time_point last_;
  std::map<std::string, double> ms_;
};

}  // namespace planecast::render
