#pragma once

#include <string>
#include <string_view>

namespace planecast::engine {

/// RFC 4648 with padding, one line.
std::string base64(std::string_view bytes);

}  // namespace planecast::engine
