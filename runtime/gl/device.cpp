#include "runtime/gl/device.h"

#include <epoxy/gl.h>

#include "material/base/issues.h"
#include "runtime/gl/device_backends.h"
#include "shaders/loden_shared.h"

namespace loden::runtime {
namespace {

std::string text(GLenum name) {
  const GLubyte* value = glGetString(name);
  return value ? reinterpret_cast<const char*>(value) : "";
}

int integer(GLenum name) {
  GLint value = 0;
  glGetIntegerv(name, &value);
  return value;
}

// The least that the runtime works with, per limit: name in words, what is there, what is needed.
void checkLimit(std::vector<std::string>& missing, const char* what, int have, int need) {
  if (have < need)
    missing.push_back(std::string(what) + ": " + std::to_string(have) + ", needed " + std::to_string(need));
}

Capabilities queryCapabilities() {
  Capabilities c;
  c.vendor = text(GL_VENDOR);
  c.renderer = text(GL_RENDERER);
  c.version = text(GL_VERSION);
  c.glsl_version = text(GL_SHADING_LANGUAGE_VERSION);
  c.software = c.renderer.find("llvmpipe") != std::string::npos ||
               c.renderer.find("softpipe") != std::string::npos ||
               c.renderer.find("SWR") != std::string::npos;
  if (epoxy_gl_version() < 45) {
    c.missing.push_back("OpenGL 4.5 core; this context is " + c.version);
    return c;
  }
  c.max_texture_side = integer(GL_MAX_TEXTURE_SIZE);
  c.max_volume_side = integer(GL_MAX_3D_TEXTURE_SIZE);
  c.max_array_layers = integer(GL_MAX_ARRAY_TEXTURE_LAYERS);
  c.max_fragment_textures = integer(GL_MAX_TEXTURE_IMAGE_UNITS);
  c.max_uniform_block_bytes = integer(GL_MAX_UNIFORM_BLOCK_SIZE);
  c.program_binary_formats = integer(GL_NUM_PROGRAM_BINARY_FORMATS);
  if (epoxy_has_gl_extension("GL_EXT_texture_filter_anisotropic"))
    glGetFloatv(GL_MAX_TEXTURE_MAX_ANISOTROPY_EXT, &c.max_anisotropy);
  checkLimit(c.missing, "textures per fragment shader", c.max_fragment_textures,
             16);  // of one material: MaterialSystem::load
  checkLimit(c.missing, "texture side", c.max_texture_side, 16384);
  checkLimit(c.missing, "volume texture side", c.max_volume_side, 2048);
  checkLimit(c.missing, "texture array layers", c.max_array_layers, 2048);
  checkLimit(c.missing, "uniform block bytes", c.max_uniform_block_bytes, int(sizeof(LodenMaterialData)));
  return c;
}

Severity severityOf(GLenum severity) {
  if (severity == GL_DEBUG_SEVERITY_HIGH) return Severity::kError;
  return severity == GL_DEBUG_SEVERITY_MEDIUM ? Severity::kWarning : Severity::kNote;
}

void APIENTRY onDebugMessage(GLenum, GLenum, GLuint id, GLenum severity, GLsizei length,
                             const GLchar* message, const void* user) {
  const std::string words = length < 0 ? std::string(message) : std::string(message, size_t(length));
  static_cast<const Device*>(user)->log(
      {issue_id::kGlDebug, severityOf(severity), "GL driver, message " + std::to_string(id), words});
}

void installDebugCallback(const Device* device) {
  glEnable(GL_DEBUG_OUTPUT);
  glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
  glDebugMessageControl(GL_DONT_CARE, GL_DONT_CARE, GL_DEBUG_SEVERITY_NOTIFICATION, 0, nullptr, GL_FALSE);
  glDebugMessageCallback(onDebugMessage, device);
}

// Around a context that somebody else owns.
class CurrentDevice final : public Device {
 public:
  explicit CurrentDevice(const DeviceOptions& options) : Device(options) {}
  void makeCurrent() override {}
  void releaseCurrent() override {}
  void swap() override {}
  glm::ivec2 size() const override { return options_.size; }
  Status recreate() override { return adoptContext(); }
};

}  // namespace

Result<std::unique_ptr<Device>> Device::create(const DeviceOptions& options) {
  if (options.kind == DeviceKind::kHeadless) return createEglDevice(options);
  if (options.kind == DeviceKind::kWindow) return createGlfwDevice(options);
  auto device = std::make_unique<CurrentDevice>(options);
  if (Status status = device->recreate(); !status) return status.issue();
  return std::unique_ptr<Device>(std::move(device));
}

void Device::log(const Issue& issue) const {
  if (options_.log) options_.log(issue);
}

Status Device::adoptContext() {
  capabilities_ = queryCapabilities();
  if (!capabilities_.missing.empty()) {
    std::string words = capabilities_.renderer + " lacks";
    for (const std::string& item : capabilities_.missing) words += "\n  " + item;
    return Issue{issue_id::kGlContext, Severity::kError, "GL device", words};
  }
  if (options_.debug && options_.kind != DeviceKind::kCurrent) installDebugCallback(this);
  return {};
}

}  // namespace loden::runtime
