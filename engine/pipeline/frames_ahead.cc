#include "engine/pipeline/frames_ahead.h"

#include <utility>

namespace planecast::engine {

FramesAhead::FramesAhead(Sequence& sequence, const slam::System& system, int begin, int end,
                         bool threaded, int step)
    : reader_(sequence, begin, end, threaded, step),
      system_(system),
      requests_(kMost),
      outcomes_(kMost) {
  if (threaded) thread_ = std::thread([this] { prepare_all(); });
}

FramesAhead::~FramesAhead() {
  requests_.close();
  outcomes_.close();
  if (thread_.joinable()) thread_.join();
}

void FramesAhead::request(bool initialised) { requests_.push(initialised); }

FramesAhead::Prepared FramesAhead::take() {
  Outcome outcome = thread_.joinable() ? *outcomes_.pop() : prepare(*requests_.pop());
  if (outcome.failure) std::rethrow_exception(outcome.failure);
  return std::move(outcome.prepared);
}

FramesAhead::Outcome FramesAhead::prepare(bool initialised) {
  try {
    const ReadFrame read = reader_.next().value();
    if (!read.error.empty()) return {{std::nullopt, read.error}, nullptr};
    return {{system_.prepare(read.frame, initialised), ""}, nullptr};
  } catch (...) {
    return {{}, std::current_exception()};
  }
}

void FramesAhead::prepare_all() {
  while (const std::optional<bool> initialised = requests_.pop()) {
    if (!outcomes_.push(prepare(*initialised))) break;
  }
}

}  // namespace planecast::engine
