#pragma once

#include <filesystem>

namespace planecast::engine {

/// Puts a complete folder in the place of another one of the same file system, which is removed.
/// Whoever looks at any moment sees the old one or the new one whole, where the file system can
/// exchange two names in one step (ext4, XFS, Btrfs, tmpfs); elsewhere there is a moment with none.
/// Throws UserError.
void replace_folder(const std::filesystem::path& with, const std::filesystem::path& folder);

}  // namespace planecast::engine
