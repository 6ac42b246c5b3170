#pragma once

#include <filesystem>
#include <string>

namespace planecast::engine {

/// Folder that holds models/, shaders/ and weights: PLANECAST_ASSETS from the environment, else
/// beside the executable (../assets, ../share/planecast/assets), else the source tree it was built
/// from, else ./assets, else share/planecast/assets below /usr/local and /usr. Throws UserError
/// when none of them is there.
std::filesystem::path assets_dir();

/// A file below it, by its path relative to the folder. Throws UserError when it is not there.
std::filesystem::path asset(const std::string& relative_path);

}  // namespace planecast::engine
