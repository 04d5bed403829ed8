// What this machine's OpenGL offers and lacks: `loden_walk --doctor`, which `loden doctor` includes.
#pragma once

namespace loden::walk {

// Prints what OpenGL offers: with `json` as a flat JSON object of the schema loden/walk-doctor/1, else one
// line per fact. Returns the exit code, which is 4 if there is no OpenGL context.
int runDoctor(bool json);

}  // namespace loden::walk
