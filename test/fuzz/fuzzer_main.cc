#include <cstdio>
#include <cstdlib>
#include <string>

#include "engine/sequence/image_file.h"
#include "test/fuzz/target.h"

/// libFuzzer's entries, one executable for all readers: PLANECAST_FUZZ in the environment names the
/// one.
namespace {

const planecast::fuzz::Target* chosen = nullptr;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  const char* name = std::getenv("PLANECAST_FUZZ");
  for (const planecast::fuzz::Target& target : planecast::fuzz::kTargets) {
    if (name != nullptr && std::string(name) == target.name) chosen = &target;
  }
  if (chosen == nullptr) {
    std::fprintf(stderr, "PLANECAST_FUZZ must name one of:");
    for (const planecast::fuzz::Target& target : planecast::fuzz::kTargets) {
      std::fprintf(stderr, " %s", target.name);
    }
    std::fprintf(stderr, "\n");
    std::exit(2);
  }
  planecast::engine::silence_codecs();
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  chosen->run({reinterpret_cast<const char*>(data), size});
  return 0;
}
