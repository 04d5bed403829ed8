// How independent pieces of work are run: the caller passes a ForEach, since the core starts no threads
// itself (material/system/threads.h provides one that does).
#pragma once

#include <functional>

namespace loden {

// Calls body(k) once for every k in [0, count), in any order, and returns when all calls are done, or after
// it was told to stop.
using ForEach = std::function<void(int count, const std::function<void(int)>& body)>;

// Runs the pieces one after the other on the calling thread.
inline void inOrder(int count, const std::function<void(int)>& body) {
  for (int k = 0; k < count; ++k) body(k);
}

}  // namespace loden
