// The callback for the runtime's messages; the runtime never prints.
#pragma once

#include <functional>

#include "material/base/result.h"

namespace loden::runtime {

// Receives a message, on the thread on which it arises; driver messages arise on the thread of the GL call.
using LogCallback = std::function<void(const Issue&)>;

}  // namespace loden::runtime
