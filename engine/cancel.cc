#include "engine/cancel.h"

#include <atomic>

namespace planecast::engine {
namespace {

std::atomic<bool> requested = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets it");

}  // namespace

void request_cancel() noexcept { requested.store(true, std::memory_order_relaxed); }
bool cancel_requested() noexcept { return requested.load(std::memory_order_relaxed); }
void clear_cancel() noexcept { requested.store(false, std::memory_order_relaxed); }

void throw_if_cancelled(const char* how_far) {
  if (cancel_requested()) throw Cancelled(how_far);
}

}  // namespace planecast::engine
