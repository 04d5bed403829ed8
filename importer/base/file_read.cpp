#include "importer/base/file_read.h"

#include <fcntl.h>
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

}  // namespace

Result<std::string> readFile(const std::filesystem::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return cannot(issue_id::kCannotOpen, path, "cannot be opened", errno);
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
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // does not wait at a pipe
  if (file < 0) return cannot(issue_id::kCannotOpen, path, "cannot be opened", errno);
  ::close(file);
  std::error_code error;
  if (what == Openable::kFile && std::filesystem::is_directory(path, error))
    return cannot(issue_id::kCannotOpen, path, "cannot be opened", EISDIR);
  return {};
}

}  // namespace loden::importer
