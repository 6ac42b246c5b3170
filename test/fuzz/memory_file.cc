#include "test/fuzz/memory_file.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace planecast::fuzz {
namespace {

namespace fs = std::filesystem;

/// Removed at the process's end.
struct Folder {
  Folder() : path("/dev/shm/planecast_fuzz_" + std::to_string(getpid())) {}
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  std::string path;
};

}  // namespace

const std::string& memory_file(std::string_view bytes) {
  static const int file = memfd_create("planecast_fuzz", 0);
  static const std::string path = "/proc/self/fd/" + std::to_string(file);
  const bool written = ftruncate(file, 0) == 0 && pwrite(file, bytes.data(), bytes.size(), 0) ==
                                                      static_cast<ssize_t>(bytes.size());
  if (!written) std::abort();
  return path;
}

const std::string& memory_folder() {
  static const Folder folder;
  fs::remove_all(folder.path);
  fs::create_directories(folder.path);
  return folder.path;
}

void put_file(const std::string& path, std::string_view bytes) {
  fs::create_directories(fs::path(path).parent_path());
  std::ofstream(path, std::ios::binary) << bytes;
}

}  // namespace planecast::fuzz
