// Turns a failed allocation into an issue (kMemory) in place of an exception.
#pragma once

#include <new>
#include <string>

#include "material/base/issues.h"
#include "material/base/result.h"

namespace loden {

// The issue that there is not enough memory for `what` (such as "this scene"). It leaves the name out if
// there is no memory even for that.
inline Issue memoryIssue(const std::string& name, const char* what) noexcept {
  try {
    return {issue_id::kMemory, Severity::kError, name, std::string("not enough memory for ") + what};
  } catch (...) {
    // Neither string is long enough to be allocated.
    return {issue_id::kMemory, Severity::kError, "", "out of memory"};
  }
}

// Runs `work`, which returns a Result or a Status, and turns std::bad_alloc into a memoryIssue.
template <class Work>
auto withMemoryIssue(const std::string& name, const char* what, const Work& work) -> decltype(work()) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    return memoryIssue(name, what);
  }
}

}  // namespace loden
