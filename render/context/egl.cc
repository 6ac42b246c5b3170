#define EGL_NO_X11
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <array>
#include <stdexcept>

#include "render/context/backends.h"
#include "render/context/shared_library.h"

namespace planecast::render {
namespace {

/// EGL on Mesa's surfaceless platform: no window system, no device node.
class EglContext final : public GlContext {
 public:
  EglContext()
      : library_({"libEGL.so.1", "libEGL.so"}),
        make_current_(library_.symbol<decltype(&eglMakeCurrent)>("eglMakeCurrent")),
        destroy_(library_.symbol<decltype(&eglDestroyContext)>("eglDestroyContext")),
        get_function_(library_.symbol<decltype(&eglGetProcAddress)>("eglGetProcAddress")) {
    open_display();
    create();
  }

  ~EglContext() override {
    make_current_(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    // The display is one for the process and stays: another renderer may be using it.
    destroy_(display_, context_);
  }

  void make_current() override {
    if (make_current_(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) != EGL_TRUE) {
      throw std::runtime_error("EGL cannot make its context current");
    }
  }

  Function function(const char* name) const override { return get_function_(name); }

 private:
  void open_display() {
    const auto get_display = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(
        get_function_("eglGetPlatformDisplayEXT"));
    if (get_display == nullptr) throw std::runtime_error("EGL lacks EGL_EXT_platform_base");
    display_ = get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    const auto initialize = library_.symbol<decltype(&eglInitialize)>("eglInitialize");
    if (display_ == EGL_NO_DISPLAY || initialize(display_, nullptr, nullptr) != EGL_TRUE) {
      throw std::runtime_error("EGL has no surfaceless display");
    }
  }

  void create() {
    const auto bind_api = library_.symbol<decltype(&eglBindAPI)>("eglBindAPI");
    const auto create_context = library_.symbol<decltype(&eglCreateContext)>("eglCreateContext");
    const std::array<EGLint, 7> attributes = {EGL_CONTEXT_MAJOR_VERSION,
                                              4,
                                              EGL_CONTEXT_MINOR_VERSION,
                                              5,
                                              EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                              EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                              EGL_NONE};
    if (bind_api(EGL_OPENGL_API) == EGL_TRUE) {
      context_ = create_context(display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes.data());
    }
    if (context_ == EGL_NO_CONTEXT) {
      throw std::runtime_error("EGL refuses an OpenGL 4.5 core context");
    }
  }

  SharedLibrary library_;
  decltype(&eglMakeCurrent) make_current_;
  decltype(&eglDestroyContext) destroy_;
  decltype(&eglGetProcAddress) get_function_;
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
};

}  // namespace

std::unique_ptr<GlContext> create_egl_context() { return std::make_unique<EglContext>(); }

}  // namespace planecast::render
