#include "material/system/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <string>

#include "material/base/issues.h"

namespace loden {
namespace {

// A file without its final name yet; removed unless it got one.
class TemporaryFile {
 public:
  // With the permissions that open() gives; mkostemp would make the file private.
  explicit TemporaryFile(const std::filesystem::path& folder) {
    static std::atomic<unsigned> next{0};
    do {
      name_ = (folder / (".loden-" + std::to_string(::getpid()) + "-" + std::to_string(next++))).string();
      file_ = ::open(name_.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
    } while (file_ < 0 && errno == EEXIST);
  }
  ~TemporaryFile() {
    if (file_ < 0) return;
    ::close(file_);
    if (!renamed_) ::unlink(name_.c_str());
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  // Each of these is false, with errno set, on failure.
  bool created() const { return file_ >= 0; }
  bool write(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
      const ssize_t put = ::write(file_, bytes.data(), bytes.size());
      if (put < 0 && errno == EINTR) continue;
      if (put < 0) return false;
      bytes = bytes.subspan(static_cast<size_t>(put));
    }
    return true;
  }
  bool flush() { return ::fsync(file_) == 0; }
  bool renameTo(const std::filesystem::path& path) {
    renamed_ = ::rename(name_.c_str(), path.c_str()) == 0;
    return renamed_;
  }

 private:
  std::string name_;
  int file_ = -1;
  bool renamed_ = false;
};

// Makes a rename inside the folder survive a power cut. File systems that cannot are left alone.
void flushFolder(const std::filesystem::path& folder) {
  const int file = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) return;
  ::fsync(file);
  ::close(file);
}

}  // namespace

Status writeFileAtomically(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  TemporaryFile temporary(folder);
  if (!temporary.created() || !temporary.write(bytes) || !temporary.flush() || !temporary.renameTo(path)) {
    return Issue{issue_id::kCannotWrite, Severity::kError, path.string(),
                 std::string("cannot write: ") + std::strerror(errno)};
  }
  flushFolder(folder);
  return {};
}

}  // namespace loden
