#include "material/system/asset_io.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "material/base/issues.h"
#include "material/system/atomic_file.h"

namespace loden {
namespace {

Issue readIssue(const std::string& name, uint64_t offset, const std::string& why) {
  return {issue_id::kCannotRead, Severity::kError, name,
          "cannot read at byte " + std::to_string(offset) + ": " + why};
}

// pread, not a mapping: a file that another process cuts short is then an issue of the part that needed the
// bytes, where a mapping raises SIGBUS in whoever touches them. Parts are read once, whole, so that a mapping
// would save one copy.
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

Result<Material> readAsset(const std::filesystem::path& path) {
  const auto source = openFileSource(path);
  if (!source) return source.issue();
  return readAsset(**source, path.string());
}

Status writeAsset(const Material& material, const std::filesystem::path& path) {
  const Result<std::vector<std::byte>> bytes = serializeAsset(material);
  if (!bytes) {
    Issue issue = bytes.issue();
    issue.where = path.string() + ": " + issue.where;
    return issue;
  }
  return writeFileAtomically(path, *bytes);
}

}  // namespace loden
