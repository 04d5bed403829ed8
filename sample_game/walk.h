// The walk itself: sets up device, materials and scene, then draws frame after frame.
#pragma once

#include "sample_game/options.h"

namespace loden::walk {

// Returns the process's exit code: 0 ok, 2 files, 3 invalid input, 4 GL or memory, 5 unsupported, 130
// interrupted.
int runWalk(const Options& options);

}  // namespace loden::walk
