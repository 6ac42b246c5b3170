#include "render/context/context.h"

#include "render/context/backends.h"

namespace planecast::render {

std::unique_ptr<GlContext> create_context(ContextKind kind) {
  return kind == ContextKind::kEgl ? create_egl_context() : create_osmesa_context();
}

}  // namespace planecast::render
