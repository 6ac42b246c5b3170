#include "app/inspect_window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <backends/imgui_impl_glfw.h>
#include <imgui.h>

#include <algorithm>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "engine/cancel.h"
#include "engine/user_error.h"

// GLFW's own header for them asks for the headers of an X extension that we do not use.
extern "C" {
Display* glfwGetX11Display(void);
Window glfwGetX11Window(GLFWwindow* window);
}

namespace planecast::app {
namespace {

constexpr double kIdleWait_s = 0.1;    ///< between pictures while nothing happens
constexpr double kBusyWait_s = 0.015;  ///< while a video plays
constexpr int kPicturesAfterInput = 3;

std::string glfw_reason() {
  const char* reason = nullptr;
  glfwGetError(&reason);
  return reason != nullptr ? reason : "unknown reason";
}

/// GLFW from its start to its end.
class WindowSystem {
 public:
  WindowSystem() {
    if (glfwInit() != GLFW_TRUE) {
      throw engine::UserError("no window can be opened (" + glfw_reason() +
                              "); --screenshot needs none");
    }
  }
  ~WindowSystem() { glfwTerminate(); }
  WindowSystem(const WindowSystem&) = delete;
  WindowSystem& operator=(const WindowSystem&) = delete;
};

struct CloseWindow {
  void operator()(GLFWwindow* window) const { glfwDestroyWindow(window); }
};
using WindowHandle = std::unique_ptr<GLFWwindow, CloseWindow>;

WindowHandle open_window(cv::Size size, const std::string& title) {
  glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
  WindowHandle window(glfwCreateWindow(size.width, size.height, title.c_str(), nullptr, nullptr));
  if (!window) throw engine::UserError("no window can be opened (" + glfw_reason() + ")");
  return window;
}

/// ImGui's input from the window. ImGui 1.86 sees keys as they are when a picture begins, so that a
/// key pressed and let go between two pictures never was: letting go waits for a picture here.
class Input {
 public:
  explicit Input(GLFWwindow* window) : window_(window) {
    glfwSetWindowUserPointer(window, this);
    ImGui_ImplGlfw_InitForOther(window, true);
    glfwSetKeyCallback(window, &Input::take_key);
  }
  ~Input() { ImGui_ImplGlfw_Shutdown(); }
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;

  /// To be called when a picture was drawn with the keys as they are.
  void picture_drawn() {
    pressed_ = false;
    for (const Key& key : std::exchange(let_go_, {})) pass_on(key);
  }

 private:
  struct Key {
    int key = 0;
    int scancode = 0;
    int action = 0;
    int mods = 0;
  };

  static void take_key(GLFWwindow* window, int key, int scancode, int action, int mods) {
    auto& input = *static_cast<Input*>(glfwGetWindowUserPointer(window));
    if (action == GLFW_PRESS) input.pressed_ = true;
    if (action == GLFW_RELEASE && input.pressed_) {
      input.let_go_.push_back({key, scancode, action, mods});
    } else {
      input.pass_on({key, scancode, action, mods});
    }
  }
  void pass_on(const Key& key) const {
    ImGui_ImplGlfw_KeyCallback(window_, key.key, key.scancode, key.action, key.mods);
  }

  GLFWwindow* window_;
  bool pressed_ = false;     ///< some key, since the last picture
  std::vector<Key> let_go_;  ///< any, since then: Ctrl is still held where S is seen
};

void put_picture(GLFWwindow* window, const cv::Mat& bgr) {
  Display* display = glfwGetX11Display();
  const Window target = glfwGetX11Window(window);
  const int screen = DefaultScreen(display);
  cv::Mat bgrx;
  cv::cvtColor(bgr, bgrx, cv::COLOR_BGR2BGRA);
  XImage* image = XCreateImage(display, DefaultVisual(display, screen),
                               static_cast<unsigned>(DefaultDepth(display, screen)), ZPixmap, 0,
                               reinterpret_cast<char*>(bgrx.data), static_cast<unsigned>(bgrx.cols),
                               static_cast<unsigned>(bgrx.rows), 32, static_cast<int>(bgrx.step));
  if (image == nullptr) throw engine::UserError("the display takes no pictures of 32 bits");
  XPutImage(display, target, DefaultGC(display, screen), image, 0, 0, 0, 0,
            static_cast<unsigned>(bgrx.cols), static_cast<unsigned>(bgrx.rows));
  XFlush(display);
  image->data = nullptr;  // the picture owns its pixels
  XDestroyImage(image);
}

}  // namespace

void show_window(engine::InspectWindow& window, engine::InspectScreen& screen, cv::Size size,
                 const std::string& title) {
  const WindowSystem system;
  const WindowHandle handle = open_window(size, title);
  screen.gui().make_current();
  Input input(handle.get());
  double last_s = glfwGetTime();
  while (glfwWindowShouldClose(handle.get()) == GLFW_FALSE && !window.wants_to_close() &&
         !engine::cancel_requested()) {
    // A click takes ImGui several pictures to answer.
    for (int i = 0; i < kPicturesAfterInput; ++i) {
      int width = 0;
      int height = 0;
      glfwGetFramebufferSize(handle.get(), &width, &height);
      if (width < 1 || height < 1) break;
      ImGui_ImplGlfw_NewFrame();
      const double now_s = glfwGetTime();
      put_picture(handle.get(), screen.draw(width, height, static_cast<float>(now_s - last_s)));
      last_s = now_s;
      input.picture_drawn();
      if (i + 1 < kPicturesAfterInput) glfwPollEvents();
    }
    glfwWaitEventsTimeout(window.view().playing ? kBusyWait_s : kIdleWait_s);
  }
}

}  // namespace planecast::app
