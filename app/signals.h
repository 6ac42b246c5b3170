#pragma once

#include <string>

namespace planecast::app {

/// From now on SIGINT and SIGTERM ask the work to stop (engine/cancel.h); the second of them ends
/// the process at once. SIGXFSZ is ignored: writing fails instead.
void stop_on_signals();

/// Of the signal that came first; 0 where none came.
int stopping_signal();
/// "SIGINT" or "SIGTERM".
std::string signal_name(int signal);
/// As shells give it for a command that ended by a signal.
int exit_status_of(int signal);

}  // namespace planecast::app
