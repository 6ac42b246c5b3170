#include "engine/benchmark/child_process.h"

#include <fcntl.h>
#include <malloc.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>

#include "engine/cancel.h"
#include "engine/program.h"
#include "engine/user_error.h"

namespace planecast::engine {
namespace {

/// A child begins as a copy of this process, whose highest mark would count as the child's own:
/// brings the mark down to what is in use now.
void lower_memory_mark() {
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";
}

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

std::string last_line_of(const std::filesystem::path& log) {
  std::ifstream in(log);
  std::string last;
  for (std::string line; std::getline(in, line);) {
    if (!line.empty()) last = line;
  }
  return last;
}

/// Files that the child is given, released with the object.
class SpawnFiles {
 public:
  explicit SpawnFiles(const std::filesystem::path& log) {
    posix_spawn_file_actions_init(&actions_);
    posix_spawn_file_actions_addopen(&actions_, STDOUT_FILENO, log.c_str(),
                                     O_WRONLY | O_CREAT | O_TRUNC, 0644);
    posix_spawn_file_actions_adddup2(&actions_, STDOUT_FILENO, STDERR_FILENO);
  }
  ~SpawnFiles() { posix_spawn_file_actions_destroy(&actions_); }
  SpawnFiles(const SpawnFiles&) = delete;
  SpawnFiles& operator=(const SpawnFiles&) = delete;

  const posix_spawn_file_actions_t* get() const { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_{};
};

pid_t start(const std::vector<std::string>& arguments, const std::filesystem::path& log) {
  std::string name = "planecast";
  std::vector<std::string> copies = arguments;
  std::vector<char*> argv = {name.data()};
  for (std::string& argument : copies) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const std::filesystem::path executable = executable_file();
  const SpawnFiles files(log);
  pid_t pid = 0;
  const int error =
      posix_spawn(&pid, executable.c_str(), files.get(), nullptr, argv.data(), environ);
  if (error != 0) {
    throw UserError(log.string() +
                    ": cannot start a process with this log: " + std::strerror(error));
  }
  return pid;
}

/// Until the child ends, which it is told to do where this process was.
void wait_or_cancel(pid_t pid) {
  constexpr int kLookEvery_ms = 50;
  // Debian 12's own declaration of it is not one for C++.
  const auto child = static_cast<int>(syscall(SYS_pidfd_open, pid, 0));
  if (child < 0) return;  // an old kernel: the child alone decides
  pollfd ended{child, POLLIN, 0};
  while (poll(&ended, 1, kLookEvery_ms) <= 0) {
    if (!cancel_requested()) continue;
    kill(pid, SIGTERM);
    break;
  }
  close(child);
}

}  // namespace

ChildResult run_this_executable(const std::vector<std::string>& arguments,
                                const std::filesystem::path& log) {
  lower_memory_mark();
  const auto begin = std::chrono::steady_clock::now();
  const pid_t pid = start(arguments, log);
  wait_or_cancel(pid);
  int status = 0;
  rusage usage{};
  while (wait4(pid, &status, 0, &usage) < 0 && errno == EINTR) {
  }
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
  ChildResult result;
  result.seconds = elapsed.count();
  result.cpu_seconds = seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime);
  result.peak_mb = static_cast<double>(usage.ru_maxrss) / 1024.0;
  if (WIFEXITED(status)) result.exit_status = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) result.signal = WTERMSIG(status);
  result.last_error_line = last_line_of(log);
  return result;
}

}  // namespace planecast::engine
