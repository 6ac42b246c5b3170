#pragma once

#include <string>

namespace planecast::engine {

/// Tells this build of the program from every other: what two of them made is not mixed.
const std::string& program_key();

}  // namespace planecast::engine
