#include <cstdio>
#include <exception>

#include "sample_game/doctor.h"
#include "sample_game/options.h"
#include "sample_game/walk.h"

int main(int argc, char** argv) {
  const loden::walk::ParsedOptions parsed = loden::walk::parseOptions(argc, argv);
  if (parsed.exit_code) return *parsed.exit_code;
  try {
    if (parsed.options.doctor) return loden::walk::runDoctor(parsed.options.json);
    return loden::walk::runWalk(parsed.options);
  } catch (const std::exception& error) {  // out of memory, most likely
    std::fprintf(stderr, "loden_walk: %s\n", error.what());
    return 4;
  }
}
