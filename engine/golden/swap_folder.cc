#include "engine/golden/swap_folder.h"

#include <fcntl.h>
#include <stdio.h>

#include <system_error>

#include "engine/user_error.h"

namespace planecast::engine {

namespace fs = std::filesystem;

namespace {

void rename_folder(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::rename(from, to, error);
  if (error) throw UserError(to.string() + ": cannot be replaced: " + error.message());
}

}  // namespace

void replace_folder(const fs::path& with, const fs::path& folder) {
  std::error_code ignored;
  if (!fs::exists(folder, ignored)) {
    rename_folder(with, folder);
    return;
  }
  if (renameat2(AT_FDCWD, with.c_str(), AT_FDCWD, folder.c_str(), RENAME_EXCHANGE) == 0) {
    fs::remove_all(with, ignored);
    return;
  }
  fs::path old = folder;
  old += ".old";
  fs::remove_all(old, ignored);
  rename_folder(folder, old);
  rename_folder(with, folder);
  fs::remove_all(old, ignored);
}

}  // namespace planecast::engine
