#pragma once

#include <filesystem>
#include <string>

namespace planecast::engine {

/// The running program's file, to be read or started again, also where it was replaced meanwhile.
std::filesystem::path executable_file();

/// The folder it stands in.
std::filesystem::path executable_folder();

/// Tells this build of the program from every other: what two of them made is not mixed.
const std::string& program_key();

}  // namespace planecast::engine
