#include "engine/pipeline/frames_ahead.h"

namespace planecast::engine {

void FramesAhead::request(bool initialised) {
  next_ = std::async(threaded_ ? std::launch::async : std::launch::deferred,
                     [this, initialised] { return prepare(initialised); });
}

FramesAhead::Prepared FramesAhead::prepare(bool initialised) {
  const ReadFrame read = reader_.next().value();
  if (!read.error.empty()) return {std::nullopt, read.error};
  return {system_.prepare(read.frame, initialised), ""};
}

}  // namespace planecast::engine
