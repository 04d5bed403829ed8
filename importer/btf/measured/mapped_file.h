// The bytes of a memory-mapped file; bytes that are not read cost no memory.
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

// Makes the process end with a message and kExitIo if it reads bytes of a mapped file that no longer exist
// because another process shortened the file. Without this call, or beyond 16 mapped files, a signal ends the
// process. It is for programs whose outputs are whole or absent whenever they end.
void exitWhereMappedFilesShrink();

}  // namespace loden::importer
