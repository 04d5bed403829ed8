// A cache of linked programs on disk, as driver binaries. A file is used only if its header, driver and
// checksum match and the driver accepts it; otherwise it counts as absent.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

#include "runtime/gl/device.h"
#include "runtime/gl/gl_objects.h"

namespace loden::runtime {

class ProgramCache {
 public:
  // An empty folder, or a driver without binaries, makes a cache that holds nothing.
  ProgramCache(const Device& device, std::filesystem::path folder);

  // The cache key: a hash of everything that decides the binary, which is the driver and all shader texts.
  uint64_t key(std::string_view vertex, std::string_view fragment) const;
  // The cached program; empty if there is none.
  GlProgram load(uint64_t key) const;
  // Writes the program to disk. A failure to write is no error: the program is compiled again next time.
  void store(uint64_t key, const GlProgram& program) const;

 private:
  std::filesystem::path path(uint64_t key) const;

  std::filesystem::path folder_;
  uint64_t driver_ = 0;
};

}  // namespace loden::runtime
