#include <GL/osmesa.h>

#include <array>
#include <cstdint>
#include <stdexcept>

#include "render/context/backends.h"
#include "render/context/shared_library.h"

namespace planecast::render {
namespace {

class OsMesaContext final : public GlContext {
 public:
  OsMesaContext()
      : library_({"libOSMesa.so.8", "libOSMesa.so"}),
        make_current_(library_.symbol<decltype(&OSMesaMakeCurrent)>("OSMesaMakeCurrent")),
        destroy_(library_.symbol<decltype(&OSMesaDestroyContext)>("OSMesaDestroyContext")),
        get_function_(library_.symbol<decltype(&OSMesaGetProcAddress)>("OSMesaGetProcAddress")) {
    const auto create =
        library_.symbol<decltype(&OSMesaCreateContextAttribs)>("OSMesaCreateContextAttribs");
    const std::array<int, 15> attributes = {OSMESA_FORMAT,
                                            OSMESA_RGBA,
                                            OSMESA_DEPTH_BITS,
                                            0,
                                            OSMESA_STENCIL_BITS,
                                            0,
                                            OSMESA_ACCUM_BITS,
                                            0,
                                            OSMESA_PROFILE,
                                            OSMESA_CORE_PROFILE,
                                            OSMESA_CONTEXT_MAJOR_VERSION,
                                            4,
                                            OSMESA_CONTEXT_MINOR_VERSION,
                                            5,
                                            0};
    context_ = create(attributes.data(), nullptr);
    if (context_ == nullptr) throw std::runtime_error("OSMesa refuses an OpenGL 4.5 core context");
  }

  ~OsMesaContext() override { destroy_(context_); }

  void make_current() override {
    // All drawing goes to framebuffer objects; the default one is a formality of four pixels.
    if (make_current_(context_, window_.data(), GL_UNSIGNED_BYTE, 2, 2) != GL_TRUE) {
      throw std::runtime_error("OSMesa cannot make its context current");
    }
  }

  Function function(const char* name) const override {
    return reinterpret_cast<Function>(get_function_(name));
  }

 private:
  SharedLibrary library_;
  decltype(&OSMesaMakeCurrent) make_current_;
  decltype(&OSMesaDestroyContext) destroy_;
  decltype(&OSMesaGetProcAddress) get_function_;
  OSMesaContext context_ = nullptr;
  std::array<std::uint8_t, 16> window_{};
};

}  // namespace

std::unique_ptr<GlContext> create_osmesa_context() { return std::make_unique<OsMesaContext>(); }

}  // namespace planecast::render
