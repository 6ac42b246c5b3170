#pragma once

#include <string>
#include <utility>
#include <vector>

namespace planecast::app {

/// The command line of this process, quoted as a shell needs it.
std::string command_line();

/// Program and libraries with their versions; `renderer` is the OpenGL driver's own description.
std::vector<std::pair<std::string, std::string>> versions(const std::string& renderer);

}  // namespace planecast::app
