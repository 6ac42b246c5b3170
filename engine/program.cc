#include "engine/program.h"

#include <fmt/format.h>
#include <sys/auxv.h>

#include <system_error>

#include "engine/output/atomic_file.h"
#include "slam/data/byte_stream.h"

namespace planecast::engine {

namespace fs = std::filesystem;

fs::path executable_file() {
  const fs::path self = "/proc/self/exe";
  std::error_code ignored;
  if (fs::exists(self, ignored)) return self;
  // No /proc, as in a bare chroot: the kernel leaves the name given to execve in the process.
  return reinterpret_cast<const char*>(getauxval(AT_EXECFN));
}

fs::path executable_folder() {
  std::error_code no_link;
  const fs::path target = fs::read_symlink(executable_file(), no_link);
  return (no_link ? executable_file() : target).parent_path();
}

const std::string& program_key() {
  static const std::string key =
      fmt::format("{:016x}", slam::checksum_of(read_file(executable_file())));
  return key;
}

}  // namespace planecast::engine
