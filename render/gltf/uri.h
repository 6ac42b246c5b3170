#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace planecast::render {

/// What a data URI holds (RFC 2397, base64 or percent-encoded). Nothing when `uri` is not a
/// well-formed data URI.
std::optional<std::vector<unsigned char>> decode_data_uri(const std::string& uri);

bool is_data_uri(const std::string& uri);

/// The file a relative reference names, below `folder`. Throws ImportError for absolute paths,
/// other schemes and references that climb out of the folder.
std::filesystem::path resolve_uri(const std::filesystem::path& folder, const std::string& uri);

}  // namespace planecast::render
