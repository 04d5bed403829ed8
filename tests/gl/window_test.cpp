// A window on a display server of the test's own (Xvfb).
#include <epoxy/gl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstring>

#include "tests/gl/gl_fixture.h"

namespace loden::test {
namespace {

using namespace runtime;

// Xvfb on a free display number; ends with the object.
class DisplayServer {
 public:
  DisplayServer() {
    int ends[2];
    if (::pipe(ends) != 0) return;
    process_ = ::fork();
    if (process_ == 0) {
      ::dup2(ends[1], 9);
      ::freopen("/dev/null", "w", stderr);
      ::execlp("Xvfb", "Xvfb", "-displayfd", "9", "-screen", "0", "640x480x24", nullptr);
      ::_exit(127);
    }
    ::close(ends[1]);
    char number[16] = {};
    number[0] = ':';
    if (::read(ends[0], number + 1, sizeof number - 2) > 0)
      name_.assign(number, 1 + std::strspn(number + 1, "0123456789"));
    ::close(ends[0]);
  }
  ~DisplayServer() {
    if (process_ <= 0) return;
    ::kill(process_, SIGTERM);
    ::waitpid(process_, nullptr, 0);
  }
  DisplayServer(const DisplayServer&) = delete;
  DisplayServer& operator=(const DisplayServer&) = delete;
  const std::string& name() const { return name_; }  // ":99"; empty if there is no Xvfb

 private:
  pid_t process_ = -1;
  std::string name_;
};

Result<std::unique_ptr<Device>> makeWindow() {
  DeviceOptions options;
  options.kind = DeviceKind::kWindow;
  options.size = {320, 200};
  options.vsync = false;
  options.debug = true;
  return Device::create(options);
}

TEST(Window, OpensDrawsAndCloses) {
  ::unsetenv("EGL_PLATFORM");  // which the headless tests set
  const DisplayServer server;
  if (server.name().empty()) GTEST_SKIP() << "Xvfb is not installed";
  ::setenv("DISPLAY", server.name().c_str(), 1);
  for (int again = 0; again < 2; ++again) {
    Result<std::unique_ptr<Device>> device = makeWindow();
    ASSERT_TRUE(device.ok()) << device.issue().text;
    EXPECT_EQ((*device)->size(), glm::ivec2(320, 200));
    EXPECT_NE((*device)->nativeWindow(), nullptr);
    GLint depth_bits = 0;
    glGetNamedFramebufferAttachmentParameteriv(0, GL_DEPTH, GL_FRAMEBUFFER_ATTACHMENT_DEPTH_SIZE,
                                               &depth_bits);
    EXPECT_GE(depth_bits, 24) << "the renderer draws into the window where no multisampling is asked for";
    glClearColor(0.5f, 0, 1, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    glm::u8vec4 pixel{0};
    glReadPixels(10, 10, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, &pixel);
    EXPECT_EQ(pixel.b, 255);
    (*device)->swap();
    (*device)->pollEvents();
    EXPECT_FALSE((*device)->closeRequested());
  }
}

TEST(Window, SaysWhyThereIsNone) {
  ::setenv("DISPLAY", ":987", 1);
  const Result<std::unique_ptr<Device>> device = makeWindow();
  ASSERT_FALSE(device.ok());
  EXPECT_FALSE(device.issue().text.empty());
}

}  // namespace
}  // namespace loden::test
