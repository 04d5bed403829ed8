#include "material/system/atomic_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string>

#include "material/base/issues.h"

namespace loden {
namespace {

// 64-bit FNV-1a, so that the temporary files of one target are found again whatever its name's length.
uint64_t hashOf(const std::string& text) {
  uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return hash;
}

// The file that is open still stands at `path`.
bool standsAt(int file, const std::string& path) {
  struct stat open {
  }, there{};
  return ::fstat(file, &open) == 0 && ::lstat(path.c_str(), &there) == 0 && open.st_dev == there.st_dev &&
         open.st_ino == there.st_ino;
}

bool isLocked(int file) {
  return ::flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
}

// Removes the file at `path` if its writer is gone. A writer holds a lock on its file, which ends with it;
// what cannot be locked at all is left alone.
void removeLeftover(const std::string& path) {
  const int file = ::open(path.c_str(), O_WRONLY | O_NONBLOCK | O_NOFOLLOW | O_CLOEXEC);
  if (file < 0) return;
  if (::flock(file, LOCK_EX | LOCK_NB) == 0 && standsAt(file, path)) ::unlink(path.c_str());
  ::close(file);
}

// A file without its final name yet; removed unless it got one.
class TemporaryFile {
 public:
  // With the permissions that open() gives; mkostemp would make the file private. Writers of the same target
  // at the same time take different numbers.
  explicit TemporaryFile(const std::filesystem::path& target) {
    constexpr int kMostWriters = 1000;
    char stem[32];
    std::snprintf(stem, sizeof stem, ".loden-%016llx-",
                  static_cast<unsigned long long>(hashOf(target.filename().string())));
    for (int number = 0; number < kMostWriters; ++number) {
      name_ = (target.parent_path() / (stem + std::to_string(number))).string();
      if (create() || errno != EEXIST) return;
    }
  }
  ~TemporaryFile() {
    if (file_ < 0) return;
    if (!renamed_) ::unlink(name_.c_str());
    ::close(file_);
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
  // False with errno EEXIST if another writer has this name.
  bool create() {
    constexpr int kFlags = O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC;
    file_ = ::open(name_.c_str(), kFlags, 0666);
    if (file_ < 0 && errno == EEXIST) {
      removeLeftover(name_);
      file_ = ::open(name_.c_str(), kFlags, 0666);
    }
    if (file_ < 0) return false;
    // Between its creation and its lock, another writer may have taken the file for a leftover.
    if (!isLocked(file_) && standsAt(file_, name_)) return true;
    ::close(file_);
    file_ = -1;
    errno = EEXIST;
    return false;
  }

  std::string name_;
  int file_ = -1;
  bool renamed_ = false;
};

Issue cannotWrite(const std::filesystem::path& path, const std::string& why) {
  return {issue_id::kCannotWrite, Severity::kError, path.string(), "cannot write: " + why};
}

// Makes a rename inside the folder survive a power cut. File systems that cannot are left alone.
void flushFolder(const std::filesystem::path& folder) {
  const int file = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) return;
  ::fsync(file);
  ::close(file);
}

}  // namespace

Status writeFileAtomically(const std::filesystem::path& path, std::span<const std::byte> bytes, Flush flush) {
  const auto issue = [&](const std::string& why) { return cannotWrite(path, why); };
  struct stat there {};
  if (::stat(path.c_str(), &there) == 0 && !S_ISREG(there.st_mode))
    return issue(S_ISDIR(there.st_mode) ? "a folder stands there" : "what stands there is no regular file");
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  TemporaryFile temporary(folder / path.filename());
  if (!temporary.created() || !temporary.write(bytes)) return issue(std::strerror(errno));
  if (flush == Flush::kNow && !temporary.flush()) return issue(std::strerror(errno));
  if (!temporary.renameTo(path)) return issue(std::strerror(errno));
  if (flush == Flush::kNow) flushFolder(folder);
  return {};
}

Status flushFileSystem(const std::filesystem::path& folder) {
  const int file = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const bool flushed = file >= 0 && ::syncfs(file) == 0;
  const int error = errno;
  if (file >= 0) ::close(file);
  if (!flushed) return cannotWrite(folder, std::strerror(error));
  return {};
}

}  // namespace loden
