#include "importer/btf/measured/mapped_file.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cstring>

#include "material/base/exit_code.h"
#include "material/base/issues.h"

namespace loden::importer {
namespace {

// What a signal's handler may read: no memory that is allocated, no locks.
struct KnownMap {
  std::atomic<const std::byte*> begin{nullptr};
  size_t size = 0;
  char name[1024] = {};
};
KnownMap known_maps[16];
std::atomic_flag known_maps_change = ATOMIC_FLAG_INIT;

class ChangeKnownMaps {
 public:
  ChangeKnownMaps() {
    while (known_maps_change.test_and_set(std::memory_order_acquire)) {
    }
  }
  ~ChangeKnownMaps() { known_maps_change.clear(std::memory_order_release); }
};

void remember(std::span<const std::byte> bytes, const std::string& name) {
  const ChangeKnownMaps change;
  for (KnownMap& map : known_maps) {
    if (map.begin) continue;
    map.size = bytes.size();
    std::strncpy(map.name, name.c_str(), sizeof map.name - 1);
    map.begin = bytes.data();
    return;
  }
}

void forget(std::span<const std::byte> bytes) {
  const ChangeKnownMaps change;
  for (KnownMap& map : known_maps)
    if (map.begin == bytes.data()) map.begin = nullptr;
}

void say(const char* text) {
  [[maybe_unused]] const ssize_t put = ::write(STDERR_FILENO, text, std::strlen(text));
}

void onLostBytes(int number, siginfo_t* info, void*) {
  const auto* at = static_cast<const std::byte*>(info->si_addr);
  for (const KnownMap& map : known_maps) {
    const std::byte* begin = map.begin;
    if (!begin || at < begin || at >= begin + map.size) continue;
    say("loden: ");
    say(map.name);
    say(": became shorter while it was read; keep it as it is until the end, or copy it first [1002]\n");
    static_assert(issue_id::kCannotRead == 1002);
    _exit(kExitIo);
  }
  signal(number, SIG_DFL);  // and again
}

}  // namespace

void exitWhereMappedFilesShrink() {
  struct sigaction action {};
  action.sa_sigaction = onLostBytes;
  action.sa_flags = SA_SIGINFO;
  sigaction(SIGBUS, &action, nullptr);
}

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
  const std::span<const std::byte> mapped(static_cast<const std::byte*>(bytes), size);
  if (size > 0) remember(mapped, path.string());
  return std::shared_ptr<const MappedFile>(new MappedFile(mapped));
}

MappedFile::~MappedFile() {
  if (bytes_.empty()) return;
  forget(bytes_);
  munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
}

}  // namespace loden::importer
