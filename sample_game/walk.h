// The walk itself: sets up device, materials and scene, then draws frame after frame.
#pragma once

#include "sample_game/options.h"

namespace loden::walk {

// Runs the walk, and returns the exit code of the process: 0 if all went well, 2 if a file cannot be read or
// written, 3 for invalid input, 4 if OpenGL or memory fails, 5 for what is not supported, 130 if interrupted.
int runWalk(const Options& options);

}  // namespace loden::walk
