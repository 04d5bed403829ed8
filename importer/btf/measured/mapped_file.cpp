#include "importer/btf/measured/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "material/base/issues.h"

namespace loden::importer {

Result<std::shared_ptr<const MappedFile>> MappedFile::open(const std::filesystem::path& path) {
  const Issue cannot_open{issue_id::kCannotOpen, Severity::kError, path.string(),
                          "no such file, or not readable"};
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // does not wait at a pipe
  if (file < 0) return cannot_open;
  struct stat status {};
  void* bytes = nullptr;
  const bool regular = fstat(file, &status) == 0 && S_ISREG(status.st_mode);
  const auto size = static_cast<size_t>(regular ? status.st_size : 0);
  if (size > 0) bytes = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file, 0);
  close(file);
  if (!regular || bytes == MAP_FAILED) return cannot_open;
  return std::shared_ptr<const MappedFile>(new MappedFile({static_cast<const std::byte*>(bytes), size}));
}

MappedFile::~MappedFile() {
  if (!bytes_.empty()) munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
}

}  // namespace loden::importer
