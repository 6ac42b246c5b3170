#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace planecast::engine {

/// Every result file is written under a temporary name in its own folder and renamed when complete,
/// so that a killed run leaves no half-written file under a final name. All functions throw
/// UserError with one line that names the file and the system's reason (read-only, full disk, not a
/// folder).

/// Creates the folder and its parents where missing.
void make_folder(const std::filesystem::path& folder);

/// The temporary name beside `path`.
std::filesystem::path temporary_path(const std::filesystem::path& path);

/// Renames the temporary of `path` to `path`, replacing what is there.
void commit_file(const std::filesystem::path& path);

/// Writes all of `bytes` to `path`.
void write_file(const std::filesystem::path& path, std::string_view bytes);

/// The whole content of a file.
std::string read_file(const std::filesystem::path& path);

}  // namespace planecast::engine
