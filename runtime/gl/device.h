// Device: a GL 4.5 core context, headless (EGL, no display server), in a window (GLFW), or the engine's own.
// Everything that the runtime draws with belongs to a Device. There is no global state, and one process may
// have several devices.
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
  // The engine's own context, which must be current on the thread that calls create() and in everything that
  // draws.
  kCurrent,
};

struct DeviceOptions {
  DeviceKind kind = DeviceKind::kHeadless;
  glm::ivec2 size{800, 600};  // size of the window, pixels
  std::string title = "Loden";
  bool vsync = true;
  // Creates a debug context, which is slower and reports driver messages of low severity and above to `log`.
  // Ignored for kCurrent.
  bool debug = false;
  LogCallback log;  // receives messages; may be empty
};

// What the driver offers, and what it lacks of what the runtime needs.
struct Capabilities {
  std::string vendor, renderer, version, glsl_version;
  // A software renderer: block compression is slow, and timer queries are not reliable.
  bool software = false;
  int max_texture_side = 0;
  int max_volume_side = 0;
  int max_array_layers = 0;
  int max_fragment_textures = 0;
  int max_uniform_block_bytes = 0;
  int program_binary_formats = 0;
  float max_anisotropy = 1;
  std::vector<std::string>
      missing;  // what the runtime needs and this driver lacks, in words; empty if the driver is usable
};

class Device {
 public:
  // A device of the given kind, whose context is current on the calling thread afterwards. Issues:
  // kGlContext.
  static Result<std::unique_ptr<Device>> create(const DeviceOptions& options);
  virtual ~Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  // Makes the context current on the calling thread, or releases it. Does nothing for kCurrent, whose context
  // the engine manages.
  virtual void makeCurrent() = 0;
  virtual void releaseCurrent() = 0;
  // Shows the frame in a window; does nothing when headless.
  virtual void swap() = 0;
  // Size of the window's framebuffer in pixels, or the size asked for when headless.
  virtual glm::ivec2 size() const = 0;
  virtual bool closeRequested() const { return false; }
  virtual void pollEvents() {}
  // The GLFWwindow*, for input and user interface; null when headless.
  virtual void* nativeWindow() const { return nullptr; }

  // Destroys the context with every object in it and creates a new one, as after a lost device. Owners of GL
  // objects must forget their names first (GlObject::release). For kCurrent the engine must have made a new
  // context current.
  virtual Status recreate() = 0;

  DeviceKind kind() const { return options_.kind; }
  const Capabilities& capabilities() const { return capabilities_; }
  // Reports an issue to the callback, if there is one.
  void log(const Issue& issue) const;
  const LogCallback& logCallback() const { return options_.log; }

 protected:
  explicit Device(const DeviceOptions& options) : options_(options) {}
  // Reads capabilities_ and installs the debug callback; called when a new context is current. Fails if the
  // context is not usable.
  Status adoptContext();

  DeviceOptions options_;
  Capabilities capabilities_;
};

}  // namespace loden::runtime
