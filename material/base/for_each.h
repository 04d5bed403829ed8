// Who runs independent pieces of work: the core starts no threads (material/system/threads.h has some).
#pragma once

#include <functional>

namespace loden {

// Calls body(k) for every k in [0, count), once, in any order, and returns when all is done, or when it was
// told to stop.
using ForEach = std::function<void(int count, const std::function<void(int)>& body)>;

// One after the other, on this thread.
inline void inOrder(int count, const std::function<void(int)>& body) {
  for (int k = 0; k < count; ++k) body(k);
}

}  // namespace loden
