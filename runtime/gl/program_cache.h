// Linked programs as driver binaries on disk. A file is used only if its header, driver and checksum fit and
// the driver takes it; anything else counts as absent.
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

  // Of everything that decides the binary: driver and all shader texts.
  uint64_t key(std::string_view vertex, std::string_view fragment) const;
  // Empty if there is none.
  GlProgram load(uint64_t key) const;
  // Failing to write is no error: the program is compiled again next time.
  void store(uint64_t key, const GlProgram& program) const;

 private:
  std::filesystem::path path(uint64_t key) const;

  std::filesystem::path folder_;
  uint64_t driver_ = 0;
};

}  // namespace loden::runtime
