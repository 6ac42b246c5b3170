#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace planecast::app {

/// Completion scripts for the whole tree of commands, to be sourced or installed where the shell
/// looks: commands, options, the values to choose from, files and folders.
std::string bash_completion(const CLI::App& root);
std::string zsh_completion(const CLI::App& root);
std::string fish_completion(const CLI::App& root);

}  // namespace planecast::app
