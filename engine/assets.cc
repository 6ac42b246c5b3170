#include "engine/assets.h"

#include <cstdlib>
#include <system_error>
#include <vector>

#include "engine/program.h"
#include "engine/user_error.h"

namespace planecast::engine {
namespace fs = std::filesystem;

fs::path assets_dir() {
  std::error_code ignored;
  if (const char* from_environment = std::getenv("PLANECAST_ASSETS")) {
    if (!fs::is_directory(from_environment, ignored)) {
      throw UserError(std::string("PLANECAST_ASSETS: ") + from_environment + ": no such folder");
    }
    return from_environment;
  }
  std::vector<fs::path> candidates;
  const fs::path folder = executable_folder();
  candidates.push_back(folder / "assets");
  candidates.push_back(folder.parent_path() / "assets");
  candidates.push_back(folder.parent_path() / "share" / "planecast" / "assets");
  // An executable in <source>/build/<preset>.
  candidates.push_back(folder.parent_path().parent_path() / "assets");
#ifdef PLANECAST_SOURCE_DIR
  candidates.push_back(fs::path(PLANECAST_SOURCE_DIR) / "assets");
#endif
  candidates.push_back("assets");
  // A program of the user's own that is linked with the installed libraries.
  candidates.push_back("/usr/local/share/planecast/assets");
  candidates.push_back("/usr/share/planecast/assets");
  for (const fs::path& candidate : candidates) {
    if (fs::is_directory(candidate / "shaders", ignored)) return candidate;
  }
  throw UserError("assets: folder not found; set PLANECAST_ASSETS to it");
}

fs::path asset(const std::string& relative_path) {
  const fs::path path = assets_dir() / relative_path;
  std::error_code ignored;
  if (!fs::exists(path, ignored)) throw UserError(path.string() + ": missing from the assets");
  return path;
}

}  // namespace planecast::engine
