#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace planecast::render {

/// The extensions of glTF that are drawn, sorted.
const std::vector<std::string>& supported_extensions();

/// Throws ImportError for the first required extension that is not supported; one warning names
/// all others that are used and not supported.
void check_extensions(const nlohmann::json& json, std::vector<std::string>& warnings);

}  // namespace planecast::render
