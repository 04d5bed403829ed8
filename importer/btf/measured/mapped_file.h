// A file's bytes, mapped: what is not read costs no memory.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>

#include "material/base/result.h"

namespace loden::importer {

class MappedFile {
 public:
  static Result<std::shared_ptr<const MappedFile>> open(const std::filesystem::path& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  explicit MappedFile(std::span<const std::byte> bytes) : bytes_(bytes) {}
  std::span<const std::byte> bytes_;
};

// From here on the process ends with a message and kExitIo where it reads bytes of a mapped file that are
// gone: where another process cut the file short. Without it, or beyond 16 mapped files, the signal ends it.
// For programs, whose outputs are whole or absent whenever they end.
void exitWhereMappedFilesShrink();

}  // namespace loden::importer
