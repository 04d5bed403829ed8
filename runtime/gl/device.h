// A GL 4.5 core context: headless (EGL, no display server) or in a window (GLFW). Everything the runtime
// draws with hangs on a Device; there is no global state, and one process may hold several.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

#include "material/base/result.h"
#include "runtime/gl/log.h"

namespace loden::runtime {

enum class DeviceKind {
  kHeadless,
  kWindow,
  kCurrent,  // the engine's own context: current on the thread that calls create() and everything that draws
};

struct DeviceOptions {
  DeviceKind kind = DeviceKind::kHeadless;
  glm::ivec2 size{800, 600};  // of the window, pixels
  std::string title = "Loden";
  bool vsync = true;
  bool debug = false;  // a debug context, slower: driver messages of low severity and above go to `log`. Not
                       // of kCurrent
  LogCallback log;     // may be empty
};

// What the driver offers, measured against what the runtime needs.
struct Capabilities {
  std::string vendor, renderer, version, glsl_version;
  bool software = false;  // rasterised on the CPU: block compression is slow, timer queries lie
  int max_texture_side = 0;
  int max_volume_side = 0;
  int max_array_layers = 0;
  int max_fragment_textures = 0;
  int max_uniform_block_bytes = 0;
  int program_binary_formats = 0;
  float max_anisotropy = 1;
  std::vector<std::string>
      missing;  // what the runtime needs and this driver lacks, in words; empty if usable
};

class Device {
 public:
  // The context is current on the calling thread afterwards. Issues: kGlContext.
  static Result<std::unique_ptr<Device>> create(const DeviceOptions& options);
  virtual ~Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  // Nothing for kCurrent, whose context the engine moves about.
  virtual void makeCurrent() = 0;
  virtual void releaseCurrent() = 0;
  // Shows the frame in a window; nothing when headless.
  virtual void swap() = 0;
  // Pixels of the window's framebuffer; the size asked for when headless.
  virtual glm::ivec2 size() const = 0;
  virtual bool closeRequested() const { return false; }
  virtual void pollEvents() {}
  // GLFWwindow* for input and user interface; null when headless.
  virtual void* nativeWindow() const { return nullptr; }

  // Drops the context with every object in it and makes a new one, as after a lost device. Owners of GL
  // objects must forget their names first (GlObject::release). kCurrent: the engine has made a new one
  // current.
  virtual Status recreate() = 0;

  DeviceKind kind() const { return options_.kind; }
  const Capabilities& capabilities() const { return capabilities_; }
  // Reports an issue to the callback, if there is one.
  void log(const Issue& issue) const;
  const LogCallback& logCallback() const { return options_.log; }

 protected:
  explicit Device(const DeviceOptions& options) : options_(options) {}
  // Called with a new current context: reads capabilities_, installs the debug callback; fails if the context
  // is not usable.
  Status adoptContext();

  DeviceOptions options_;
  Capabilities capabilities_;
};

}  // namespace loden::runtime
