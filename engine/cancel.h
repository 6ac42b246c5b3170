#pragma once

#include <stdexcept>

namespace planecast::engine {

/// Long work looks here once a frame, so that it can be ended between two frames with what was done
/// so far complete on disk. The flag is the process's, as the signals are that set it.

/// Asks everything that runs to stop. Async-signal-safe.
void request_cancel() noexcept;
bool cancel_requested() noexcept;
/// Takes the request back, for a process that goes on after it.
void clear_cancel() noexcept;

/// Work that ended because it was asked to; the message says how far it came.
class Cancelled : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws Cancelled where it was asked for.
void throw_if_cancelled(const char* how_far = "nothing was completed");

}  // namespace planecast::engine
