#include "render/context/shared_library.h"

#include <dlfcn.h>

#include <stdexcept>

namespace planecast::render {

SharedLibrary::SharedLibrary(const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    handle_ = dlopen(name.c_str(), RTLD_LOCAL | RTLD_NOW);
    name_ = name;
    if (handle_ != nullptr) return;
  }
  throw std::runtime_error("cannot open " + names.front());
}

void* SharedLibrary::address(const char* name) const {
  void* found = dlsym(handle_, name);
  if (found == nullptr) throw std::runtime_error(name_ + " has no " + name);
  return found;
}

}  // namespace planecast::render
