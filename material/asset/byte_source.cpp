#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "material/asset/asset.h"
#include "material/base/issues.h"

namespace loden {
namespace {

Issue readIssue(const std::string& name, uint64_t offset, const std::string& why) {
  return {issue_id::kCannotRead, Severity::kError, name,
          "cannot read at byte " + std::to_string(offset) + ": " + why};
}

// pread, not a mapping: a file that another process cuts short is then an issue of the part that needed the bytes, where a
// mapping raises SIGBUS in whoever touches them. Parts are read once, whole, so that a mapping would save one copy.
class FileSource final : public ByteSource {
 public:
  FileSource(int file, uint64_t size, std::string name) : file_(file), size_(size), name_(std::move(name)) {}
  ~FileSource() override { ::close(file_); }
  FileSource(const FileSource&) = delete;
  FileSource& operator=(const FileSource&) = delete;

  uint64_t size() const override { return size_; }

  Status read(uint64_t offset, std::span<std::byte> into) const override {
    while (!into.empty()) {
      const ssize_t got = ::pread(file_, into.data(), into.size(), static_cast<off_t>(offset));
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) return readIssue(name_, offset, std::strerror(errno));
      if (got == 0) return readIssue(name_, offset, "the file ends here");
      offset += static_cast<uint64_t>(got);
      into = into.subspan(static_cast<size_t>(got));
    }
    return {};
  }

 private:
  int file_;
  uint64_t size_;
  std::string name_;
};

class MemorySource final : public ByteSource {
 public:
  MemorySource(std::vector<std::byte> bytes, std::string name)
      : bytes_(std::move(bytes)), name_(std::move(name)) {}

  uint64_t size() const override { return bytes_.size(); }

  Status read(uint64_t offset, std::span<std::byte> into) const override {
    if (offset > bytes_.size() || into.size() > bytes_.size() - offset) {
      return readIssue(name_, offset, "beyond the end");
    }
    std::copy_n(bytes_.begin() + static_cast<ptrdiff_t>(offset), into.size(), into.begin());
    return {};
  }

 private:
  std::vector<std::byte> bytes_;
  std::string name_;
};

}  // namespace

Result<std::unique_ptr<ByteSource>> openFileSource(const std::filesystem::path& path) {
  const auto issue = [&](const std::string& why) {
    return Issue{issue_id::kCannotOpen, Severity::kError, path.string(), "cannot open: " + why};
  };
  // O_NONBLOCK: opening a pipe does not wait for a writer.
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0) return issue(std::strerror(errno));
  struct stat status {};
  if (::fstat(file, &status) != 0 || !S_ISREG(status.st_mode)) {
    ::close(file);
    return issue("not a regular file");
  }
  return std::unique_ptr<ByteSource>(
      std::make_unique<FileSource>(file, static_cast<uint64_t>(status.st_size), path.string()));
}

std::unique_ptr<ByteSource> memorySource(std::vector<std::byte> bytes, std::string name) {
  return std::make_unique<MemorySource>(std::move(bytes), std::move(name));
}

}  // namespace loden
