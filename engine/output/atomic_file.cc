#include "engine/output/atomic_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

#include "engine/user_error.h"

namespace planecast::engine {
namespace {

namespace fs = std::filesystem;

struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, FileCloser>;

/// Removes the temporary before it throws: nothing is left behind on a full disk.
[[noreturn]] void fail_writing(const fs::path& path, int error) {
  std::error_code ignored;
  fs::remove(temporary_path(path), ignored);
  throw UserError(fmt::format("{}: cannot write: {}", path.string(), std::strerror(error)));
}

}  // namespace

void make_folder(const fs::path& folder) {
  if (folder.empty()) return;
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    throw UserError(fmt::format("{}: cannot create folder: {}", folder.string(), error.message()));
  }
  if (!fs::is_directory(folder, error)) {
    throw UserError(fmt::format("{}: is not a folder", folder.string()));
  }
}

fs::path temporary_path(const fs::path& path) {
  fs::path temporary = path;
  temporary += ".part";
  return temporary;
}

void commit_file(const fs::path& path) {
  std::error_code error;
  fs::rename(temporary_path(path), path, error);
  if (error) fail_writing(path, error.value());
}

void write_file(const fs::path& path, std::string_view bytes) {
  const fs::path temporary = temporary_path(path);
  File file(std::fopen(temporary.c_str(), "wb"));
  if (!file) fail_writing(path, errno);
  if (std::fwrite(bytes.data(), 1, bytes.size(), file.get()) != bytes.size()) {
    fail_writing(path, errno);
  }
  // Closing flushes the rest: a full disk may show only here.
  if (std::fclose(file.release()) != 0) fail_writing(path, errno);
  commit_file(path);
}

std::string read_file(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) {
    throw UserError(fmt::format("{}: is a folder, not a file", path.string()));
  }
  if (fs::exists(path, error) && !fs::is_regular_file(path, error)) {
    throw UserError(fmt::format("{}: not a file", path.string()));
  }
  const File file(std::fopen(path.c_str(), "rb"));
  if (!file) throw UserError(fmt::format("{}: {}", path.string(), std::strerror(errno)));
  std::string bytes;
  char block[1 << 16];
  std::size_t count = 0;
  while ((count = std::fread(block, 1, sizeof(block), file.get())) > 0) bytes.append(block, count);
  if (std::ferror(file.get()) != 0) {
    throw UserError(fmt::format("{}: cannot read: {}", path.string(), std::strerror(errno)));
  }
  return bytes;
}

}  // namespace planecast::engine
