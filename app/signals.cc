#include "app/signals.h"

#include <signal.h>
#include <unistd.h>

#include <atomic>

#include "engine/cancel.h"

namespace planecast::app {
namespace {

std::atomic<int> first_signal = 0;
static_assert(std::atomic<int>::is_always_lock_free, "a signal handler sets it");

extern "C" void on_stop_signal(int signal) {
  int none = 0;
  if (!first_signal.compare_exchange_strong(none, signal)) _exit(exit_status_of(signal));
  engine::request_cancel();
}

}  // namespace

void stop_on_signals() {
  struct sigaction action {};
  action.sa_handler = on_stop_signal;
  // Reads and waits of the libraries go on: the work looks at the flag by itself.
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  for (const int signal : {SIGINT, SIGTERM}) {
    struct sigaction before {};
    // What the parent wants ignored (nohup, a job in the background) stays so.
    sigaction(signal, nullptr, &before);
    if (before.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);
  }
  // A file that may not grow further is an error of writing as any other.
  ::signal(SIGXFSZ, SIG_IGN);
}

int stopping_signal() { return first_signal.load(); }

std::string signal_name(int signal) { return signal == SIGINT ? "SIGINT" : "SIGTERM"; }

int exit_status_of(int signal) {
  constexpr int kBySignal = 128;
  return kBySignal + signal;
}

}  // namespace planecast::app
