#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace planecast::engine {

/// JSON as text, each level indented by `indent` spaces. Names of files need not be UTF-8: what is
/// not is replaced.
std::string json_text(const nlohmann::ordered_json& json, int indent = 1);

}  // namespace planecast::engine
