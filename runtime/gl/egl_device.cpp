// Headless contexts: EGL without a surface, on Mesa's surfaceless platform or on the first EGL device.
#include <epoxy/egl.h>

#include <cstdio>
#include <string_view>

#include "material/base/issues.h"
#include "runtime/gl/device_backends.h"

namespace loden::runtime {
namespace {

Issue eglIssue(const std::string& what) {
  char code[16];
  std::snprintf(code, sizeof code, "0x%04x", unsigned(eglGetError()));
  return {issue_id::kGlContext, Severity::kError, "EGL",
          what + " (" + code + "); a GL 4.5 driver is needed, Mesa's llvmpipe is one (package libegl-mesa0)"};
}

bool hasWord(const char* list, std::string_view word) {
  std::string_view rest = list ? list : "";
  while (!rest.empty()) {
    const size_t end = rest.find(' ');
    if (rest.substr(0, end) == word) return true;
    rest = end == std::string_view::npos ? std::string_view{} : rest.substr(end + 1);
  }
  return false;
}

EGLDisplay deviceDisplay() {
  EGLDeviceEXT device = nullptr;
  EGLint count = 0;
  if (!eglQueryDevicesEXT(1, &device, &count) || count == 0) return EGL_NO_DISPLAY;
  return eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, device, nullptr);
}

// The first display that initialises. Displays are shared by all devices of the process, and stay
// initialised: eglTerminate would end the other devices too.
EGLDisplay openDisplay() {
  const char* client = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  EGLDisplay display = EGL_NO_DISPLAY;
  if (hasWord(client, "EGL_MESA_platform_surfaceless") && hasWord(client, "EGL_EXT_platform_base")) {
    display = eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (display != EGL_NO_DISPLAY && eglInitialize(display, nullptr, nullptr)) return display;
  }
  if (hasWord(client, "EGL_EXT_platform_device") && hasWord(client, "EGL_EXT_device_enumeration")) {
    display = deviceDisplay();
    if (display != EGL_NO_DISPLAY && eglInitialize(display, nullptr, nullptr)) return display;
  }
  return EGL_NO_DISPLAY;
}

Result<EGLContext> makeContext(EGLDisplay display, bool debug) {
  if (!eglBindAPI(EGL_OPENGL_API)) return eglIssue("no OpenGL in this EGL");
  const EGLint wanted[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, 0, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (!eglChooseConfig(display, wanted, &config, 1, &count) || count == 0)
    return eglIssue("no configuration for OpenGL");
  const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                               4,
                               EGL_CONTEXT_MINOR_VERSION,
                               5,
                               EGL_CONTEXT_OPENGL_PROFILE_MASK,
                               EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                               EGL_CONTEXT_OPENGL_DEBUG,
                               debug ? EGL_TRUE : EGL_FALSE,
                               EGL_NONE};
  const EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, attributes);
  if (context == EGL_NO_CONTEXT) return eglIssue("no OpenGL 4.5 core context");
  return context;
}

class EglDevice final : public Device {
 public:
  explicit EglDevice(const DeviceOptions& options) : Device(options) {}
  ~EglDevice() override { destroyContext(); }

  Status start() {
    display_ = openDisplay();
    if (display_ == EGL_NO_DISPLAY) return eglIssue("no display without a surface");
    if (!hasWord(eglQueryString(display_, EGL_EXTENSIONS), "EGL_KHR_surfaceless_context"))
      return eglIssue("EGL_KHR_surfaceless_context is missing");
    Result<EGLContext> context = makeContext(display_, options_.debug);
    if (!context) return context.issue();
    context_ = *context;
    if (!eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_))
      return eglIssue("cannot use the context");
    return adoptContext();
  }

  void makeCurrent() override { eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_); }
  void releaseCurrent() override { eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT); }
  void swap() override {}
  glm::ivec2 size() const override { return options_.size; }
  Status recreate() override {
    destroyContext();
    return start();
  }

 private:
  void destroyContext() {
    if (context_ == EGL_NO_CONTEXT) return;
    if (eglGetCurrentContext() == context_) releaseCurrent();
    eglDestroyContext(display_, context_);
    context_ = EGL_NO_CONTEXT;
  }

  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
};

}  // namespace

Result<std::unique_ptr<Device>> createEglDevice(const DeviceOptions& options) {
  auto device = std::make_unique<EglDevice>(options);
  if (Status status = device->start(); !status) return status.issue();
  return std::unique_ptr<Device>(std::move(device));
}

}  // namespace loden::runtime
