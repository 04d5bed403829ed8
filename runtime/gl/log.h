// Where the runtime's messages go: it never prints.
#pragma once

#include <functional>

#include "material/base/result.h"

namespace loden::runtime {

// Called on the thread on which the message arises, which for driver messages is the thread of the GL call.
using LogCallback = std::function<void(const Issue&)>;

}  // namespace loden::runtime
