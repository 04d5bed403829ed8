// Contexts in a window.
#include "material/base/issues.h"
#include "runtime/gl/device_backends.h"

#ifdef LODEN_WITH_GLFW

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <mutex>

namespace loden::runtime {
namespace {

// GLFW initialises once per process; the last window ends it.
class GlfwLibrary {
 public:
  static std::shared_ptr<GlfwLibrary> acquire() {
    static std::mutex mutex;
    static std::weak_ptr<GlfwLibrary> shared;
    std::lock_guard lock(mutex);
    std::shared_ptr<GlfwLibrary> library = shared.lock();
    if (!library && glfwInit()) shared = library = std::shared_ptr<GlfwLibrary>(new GlfwLibrary);
    return library;
  }
  ~GlfwLibrary() { glfwTerminate(); }

 private:
  GlfwLibrary() = default;
};

Issue glfwIssue(const std::string& what) {
  const char* words = nullptr;
  glfwGetError(&words);
  return {issue_id::kGlContext, Severity::kError, "GLFW", what + ": " + (words ? words : "unknown reason")};
}

class GlfwDevice final : public Device {
 public:
  explicit GlfwDevice(const DeviceOptions& options) : Device(options) {}
  ~GlfwDevice() override { closeWindow(); }

  Status start() {
    library_ = GlfwLibrary::acquire();
    if (!library_) return glfwIssue("no window system");
    // EGL first, as headless devices use it; GLX and WGL where it is missing.
    if (!openWindow(GLFW_EGL_CONTEXT_API) && !openWindow(GLFW_NATIVE_CONTEXT_API))
      return glfwIssue("no window with an OpenGL 4.5 core context");
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(options_.vsync ? 1 : 0);
    return adoptContext();
  }

  void makeCurrent() override { glfwMakeContextCurrent(window_); }
  void releaseCurrent() override { glfwMakeContextCurrent(nullptr); }
  void swap() override { glfwSwapBuffers(window_); }
  glm::ivec2 size() const override {
    glm::ivec2 pixels{0};
    glfwGetFramebufferSize(window_, &pixels.x, &pixels.y);
    return pixels;
  }
  bool closeRequested() const override { return glfwWindowShouldClose(window_); }
  void pollEvents() override { glfwPollEvents(); }
  void* nativeWindow() const override { return window_; }
  Status recreate() override {
    closeWindow();
    return start();
  }

 private:
  bool openWindow(int context_api) {
    glfwDefaultWindowHints();
    glfwWindowHint(GLFW_CONTEXT_CREATION_API, context_api);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, options_.debug);
    glfwWindowHint(GLFW_SRGB_CAPABLE, GLFW_TRUE);
    glfwWindowHint(GLFW_DEPTH_BITS,
                   24);  // with one sample a pixel, scenes are drawn straight into the window
    window_ = glfwCreateWindow(options_.size.x, options_.size.y, options_.title.c_str(), nullptr, nullptr);
    return window_ != nullptr;
  }
  void closeWindow() {
    if (window_) glfwDestroyWindow(window_);
    window_ = nullptr;
  }

  std::shared_ptr<GlfwLibrary> library_;
  GLFWwindow* window_ = nullptr;
};

}  // namespace

Result<std::unique_ptr<Device>> createGlfwDevice(const DeviceOptions& options) {
  auto device = std::make_unique<GlfwDevice>(options);
  if (Status status = device->start(); !status) return status.issue();
  return std::unique_ptr<Device>(std::move(device));
}

}  // namespace loden::runtime

#else

namespace loden::runtime {

Result<std::unique_ptr<Device>> createGlfwDevice(const DeviceOptions&) {
  return Issue{issue_id::kGlContext, Severity::kError, "GLFW",
               "this build has no windows; build with LODEN_WITH_GLFW"};
}

}  // namespace loden::runtime

#endif
