// Preloaded into a tool, makes system calls on files fail, as a full disk or a broken one does.
//   LODEN_FAULT=CALL:N:ERRNO:PREFIX   CALL: read, write, fsync or rename. The N-th such call (from 1) on a
//   file
//                                     whose path begins with PREFIX does half of what it was asked for, if it
//                                     can; it, or else the next, fails with the error, and so do all that
//                                     follow.
//   LODEN_FAULT_HIT=FILE              is made when a call fails.
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>

namespace {

struct Fault {
  char call[16] = {};
  long at = 0;
  int error = 0;
  char prefix[4096] = {};
  std::atomic<long> met{0};
  std::atomic<bool> broken{false};
};

Fault& fault() {
  static Fault* const the_fault = [] {
    auto* made = new Fault;
    if (const char* text = getenv("LODEN_FAULT"))
      sscanf(text, "%15[^:]:%ld:%d:%4095s", made->call, &made->at, &made->error, made->prefix);
    return made;
  }();
  return *the_fault;
}

bool isBelow(const char* path) {
  return strncmp(path, fault().prefix, strlen(fault().prefix)) == 0;
}

bool isBelow(int file) {
  char link[32], path[4096];
  snprintf(link, sizeof link, "/proc/self/fd/%d", file);
  const ssize_t length = syscall(SYS_readlinkat, AT_FDCWD, link, path, sizeof path - 1);
  if (length < 0) return false;
  path[length] = '\0';
  return isBelow(path);
}

enum class Do { kAll, kHalf, kFail };

template <class File>
Do next(const char* call, File file) {
  Fault& f = fault();
  if (f.at < 1 || strcmp(call, f.call) != 0 || !isBelow(file)) return Do::kAll;
  if (!f.broken) {
    const long number = ++f.met;
    if (number < f.at) return Do::kAll;
    f.broken = true;
    if (const char* hit = getenv("LODEN_FAULT_HIT"))
      syscall(SYS_close, syscall(SYS_openat, AT_FDCWD, hit, O_CREAT | O_WRONLY, 0600));
    return Do::kHalf;
  }
  return Do::kFail;
}

template <class Function>
Function real(const char* name, Function) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

// `bytes` of a call that moves bytes; 0 where it is to fail, with errno set.
size_t allowed(const char* call, int file, size_t bytes) {
  const Do what = next(call, file);
  if (what == Do::kAll) return bytes;
  if (what == Do::kHalf && bytes > 1) return bytes / 2;
  errno = fault().error;
  return 0;
}

}  // namespace

extern "C" {

ssize_t write(int file, const void* from, size_t bytes) {
  const size_t now = allowed("write", file, bytes);
  if (now == 0 && bytes > 0) return -1;
  return syscall(SYS_write, file, from, now);
}

ssize_t writev(int file, const struct iovec* parts, int count) {
  const size_t bytes = count > 0 ? parts[0].iov_len : 0, now = allowed("write", file, bytes);
  if (now == 0 && bytes > 0) return -1;
  if (now < bytes) return syscall(SYS_write, file, parts[0].iov_base, now);
  return syscall(SYS_writev, file, parts, count);
}

ssize_t read(int file, void* into, size_t bytes) {
  const size_t now = allowed("read", file, bytes);
  if (now == 0 && bytes > 0) return -1;
  return syscall(SYS_read, file, into, now);
}
ssize_t __read_chk(int file, void* into, size_t bytes, size_t) {
  return read(file, into, bytes);
}

ssize_t pread64(int file, void* into, size_t bytes, off64_t offset) {
  const size_t now = allowed("read", file, bytes);
  if (now == 0 && bytes > 0) return -1;
  return syscall(SYS_pread64, file, into, now, offset);
}
ssize_t pread(int file, void* into, size_t bytes, off_t offset) {
  return pread64(file, into, bytes, offset);
}

size_t fread(void* into, size_t size, size_t count, FILE* file) {
  const size_t now = size > 0 ? allowed("read", fileno(file), count) : count;
  static const auto whole = real("fread", &fread);
  return now > 0 ? whole(into, size, now, file) : 0;
}

int fsync(int file) {
  if (next("fsync", file) == Do::kAll) return int(syscall(SYS_fsync, file));
  errno = fault().error;
  return -1;
}

int syncfs(int file) {
  if (next("fsync", file) == Do::kAll) return int(syscall(SYS_syncfs, file));
  errno = fault().error;
  return -1;
}

int rename(const char* from, const char* to) {
  if (next("rename", to) == Do::kAll) return int(syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
  errno = fault().error;
  return -1;
}

}  // extern "C"
