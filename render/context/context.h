#pragma once

#include <memory>

#include "render/renderer.h"

namespace planecast::render {

/// An OpenGL 4.5 core context without a window. The library behind it is opened at run time, so
/// that it neither binds nor meets the libGL of others in the process.
class GlContext {
 public:
  using Function = void (*)();

  virtual ~GlContext() = default;
  /// Throws std::runtime_error when the driver refuses.
  virtual void make_current() = 0;
  /// The driver may answer an unknown name with a stub: check the GL version, not the pointer.
  virtual Function function(const char* name) const = 0;
};

/// Throws std::runtime_error with one line saying which library or step failed.
std::unique_ptr<GlContext> create_context(ContextKind kind);

}  // namespace planecast::render
