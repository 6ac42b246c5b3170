#pragma once

#include <string>

namespace planecast::engine {

/// A field of a comma-separated line (RFC 4180), with line breaks made spaces: one record stays one
/// line.
std::string csv_field(std::string text);

}  // namespace planecast::engine
