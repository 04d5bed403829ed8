// What this machine's OpenGL offers and lacks: `loden_walk --doctor`, which `loden doctor` includes.
#pragma once

namespace loden::walk {

// Prints a flat JSON object, schema loden/walk-doctor/1, or one line per fact. Returns the exit code: 4
// without a context.
int runDoctor(bool json);

}  // namespace loden::walk
