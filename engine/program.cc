#include "engine/program.h"

#include <fmt/format.h>

#include "engine/output/atomic_file.h"
#include "slam/data/byte_stream.h"

namespace planecast::engine {

const std::string& program_key() {
  static const std::string key =
      fmt::format("{:016x}", slam::checksum_of(read_file("/proc/self/exe")));
  return key;
}

}  // namespace planecast::engine
