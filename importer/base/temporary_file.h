// A file that gets its name when it is complete.
#pragma once

#include <filesystem>
#include <system_error>

namespace loden::importer {

// Removes the file at `path` at its end, unless it has been renamed by then.
class TemporaryFile {
 public:
  explicit TemporaryFile(std::filesystem::path path) : path_(std::move(path)) {}
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    std::error_code error;
    if (!path_.empty()) std::filesystem::remove(path_, error);
  }

  const std::filesystem::path& path() const { return path_; }
  std::error_code renameTo(const std::filesystem::path& to) {
    std::error_code error;
    std::filesystem::rename(path_, to, error);
    if (!error) path_.clear();
    return error;
  }

 private:
  std::filesystem::path path_;
};

}  // namespace loden::importer
