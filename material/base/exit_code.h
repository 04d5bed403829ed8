// The exit codes of all tools, and the exit code that belongs to an issue.
#pragma once

#include "material/base/issues.h"
#include "material/base/result.h"

namespace loden {

// The exit codes, as `loden --help` documents them; they are never renumbered.
enum ExitCode {
  kExitOk = 0,
  kExitUsage = 1,
  kExitIo = 2,
  kExitInvalid = 3,
  kExitRuntime = 4,
  kExitUnsupported = 5,
  kExitDifference = 7,
  kExitInterrupted = 130,
};

constexpr ExitCode exitCodeOf(int id) {
  if (id == issue_id::kOption) return kExitUsage;
  if (id == issue_id::kVersion || id == issue_id::kUnknownCritical || id == issue_id::kGltfRequired)
    return kExitUnsupported;
  if (id == issue_id::kImage)
    return kExitInvalid;  // the file is there, but not the picture that it should be
  if (id < 2000) return kExitIo;
  return id < 7000 ? kExitInvalid : kExitRuntime;
}
inline ExitCode exitCodeOf(const Issue& issue) {
  return exitCodeOf(issue.id);
}

}  // namespace loden
