#pragma once

#include <memory>

#include "render/context/context.h"

namespace planecast::render {

std::unique_ptr<GlContext> create_osmesa_context();
std::unique_ptr<GlContext> create_egl_context();

}  // namespace planecast::render
