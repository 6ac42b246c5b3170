#include "engine/pipeline/frames_ahead.h"

#include "engine/user_error.h"

namespace planecast::engine {

void FramesAhead::request(int index, bool initialised) {
  next_ = std::async(threaded_ ? std::launch::async : std::launch::deferred,
                     [this, index, initialised] { return prepare(index, initialised); });
}

FramesAhead::Prepared FramesAhead::prepare(int index, bool initialised) const {
  Prepared prepared;
  try {
    prepared.image = system_.prepare(sequence_.read(index), initialised);
  } catch (const UserError& error) {
    prepared.error = error.what();
  }
  return prepared;
}

}  // namespace planecast::engine
