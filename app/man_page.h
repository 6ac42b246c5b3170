#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace planecast::app {

/// planecast.1, in the language of man(7), from the same tree that prints the help.
std::string man_page(const CLI::App& root, const std::string& version);

}  // namespace planecast::app
