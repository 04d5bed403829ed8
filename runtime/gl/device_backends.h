// Private to the runtime: the two functions that create devices.
#pragma once

#include "runtime/gl/device.h"

namespace loden::runtime {

Result<std::unique_ptr<Device>> createEglDevice(const DeviceOptions& options);
// A device in a window. Issues: kGlContext, also if the library was built without GLFW.
Result<std::unique_ptr<Device>> createGlfwDevice(const DeviceOptions& options);

}  // namespace loden::runtime
