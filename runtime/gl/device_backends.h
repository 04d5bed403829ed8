// Private to the runtime: the two makers of devices.
#pragma once

#include "runtime/gl/device.h"

namespace loden::runtime {

Result<std::unique_ptr<Device>> createEglDevice(const DeviceOptions& options);
// kGlContext where the library is built without GLFW.
Result<std::unique_ptr<Device>> createGlfwDevice(const DeviceOptions& options);

}  // namespace loden::runtime
