#include "importer/base/file_read.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "material/base/issues.h"

namespace loden::importer {
namespace {

Issue cannot(int id, const std::filesystem::path& path, const char* what, int error) {
  return {id, Severity::kError, path.string(), std::string(what) + ": " + std::strerror(error)};
}

// Open for reading, a regular file, or a folder if that is allowed. What else stands there is not waited for:
// a pipe opens at once, and is refused.
Result<int> openToRead(const std::filesystem::path& path, bool folders) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0) return cannot(issue_id::kCannotOpen, path, "cannot be opened", errno);
  struct stat status {};
  const int error = ::fstat(file, &status) != 0 ? errno : 0;
  if (error == 0 && (S_ISREG(status.st_mode) || (folders && S_ISDIR(status.st_mode)))) return file;
  ::close(file);
  if (error != 0 || S_ISDIR(status.st_mode))
    return cannot(issue_id::kCannotOpen, path, "cannot be opened", error != 0 ? error : EISDIR);
  return Issue{issue_id::kCannotOpen, Severity::kError, path.string(), "is no regular file"};
}

}  // namespace

Result<std::string> readFile(const std::filesystem::path& path) {
  const Result<int> opened = openToRead(path, false);
  if (!opened) return opened.issue();
  const int file = *opened;
  std::string bytes;
  std::array<char, 1 << 16> block;
  ssize_t got = 0;
  while ((got = ::read(file, block.data(), block.size())) > 0 || (got < 0 && errno == EINTR))
    if (got > 0) bytes.append(block.data(), static_cast<size_t>(got));
  const int error = errno;
  ::close(file);
  if (got < 0) return cannot(issue_id::kCannotRead, path, "cannot be read", error);
  return bytes;
}

Status checkOpens(const std::filesystem::path& path, Openable what) {
  const Result<int> file = openToRead(path, what == Openable::kFileOrFolder);
  if (!file) return file.issue();
  ::close(*file);
  return {};
}

}  // namespace loden::importer
