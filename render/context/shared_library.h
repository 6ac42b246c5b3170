#pragma once

#include <string>
#include <vector>

namespace planecast::render {

/// A library opened at run time with its symbols kept to itself. It stays loaded to the end of the
/// process: drivers leave threads and thread-local destructors behind that must not lose their
/// code.
class SharedLibrary {
 public:
  /// Tries the names in order; throws std::runtime_error when none opens.
  explicit SharedLibrary(const std::vector<std::string>& names);

  /// Throws std::runtime_error when the symbol is absent.
  template <typename F>
  F symbol(const char* name) const {
    return reinterpret_cast<F>(address(name));
  }

 private:
  void* address(const char* name) const;

  void* handle_ = nullptr;
  std::string name_;
};

}  // namespace planecast::render
