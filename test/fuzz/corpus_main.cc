#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "engine/sequence/image_file.h"
#include "test/fuzz/target.h"

/// Runs readers over the files of their corpora: fuzz_corpus FOLDER [TARGET...], where FOLDER holds
/// one folder for each target. What fuzzing has found stays found.
namespace {

using namespace planecast;
namespace fs = std::filesystem;

std::string bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

int run(const fuzz::Target& target, const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    // Before, so that the last line names the one that crashes.
    std::printf("%s\n", file.c_str());
    std::fflush(stdout);
    target.run(bytes_of(file));
  }
  return static_cast<int>(files.size());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  engine::silence_codecs();
  const std::vector<std::string> wanted(argv + 2, argv + argc);
  int targets = 0;
  for (const fuzz::Target& target : fuzz::kTargets) {
    if (!wanted.empty() && std::ranges::find(wanted, target.name) == wanted.end()) continue;
    if (run(target, fs::path(argv[1]) / target.name) == 0) {
      std::fprintf(stderr, "%s: an empty corpus\n", target.name);
      return 1;
    }
    ++targets;
  }
  std::printf("%d readers\n", targets);
  return targets > 0 ? 0 : 2;
}
