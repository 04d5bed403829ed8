// Replaces the allocator of a program by one that fails where a test says. A test program of its own includes
// this file, in one source file.
#pragma once

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <new>

namespace loden::test {

// Whether an allocation by this thread counts. `caller` is the address of the code that allocates, or null if
// it is not known. Each program defines this function.
bool allocationCounts(const void* caller);

// Counts allocations and decides which of them fail. Those that count are numbered from 0.
struct Allocations {
  std::atomic<long> made{0}, live{0};
  std::atomic<long> fail_at{-1}, fail_count{1};  // the first that fails, or -1, and how many from there on

  // Starts to count from 0, and lets `count` allocations fail from number first_to_fail on; -1: none.
  void begin(long first_to_fail, long count = 1) {
    made = live = 0;
    fail_count = count, fail_at = first_to_fail;
  }
  bool fails(const void* caller) {
    if (!allocationCounts(caller)) return false;
    const long number = made++, first = fail_at;
    if (first >= 0 && number >= first && number - first < fail_count) return true;
    ++live;
    return false;
  }
  void freed(const void* pointer) {
    if (pointer && allocationCounts(nullptr)) --live;
  }
};
inline constinit Allocations allocations;

}  // namespace loden::test

// With LODEN_FAIL_MALLOC allocations of C libraries count too, except with sanitizers, which have their own
// malloc.
#if defined(LODEN_FAIL_MALLOC) && defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
extern "C" {
void* __libc_malloc(size_t);
void* __libc_calloc(size_t, size_t);
void __libc_free(void*);

void* malloc(size_t bytes) {
  if (!loden::test::allocations.fails(nullptr)) return __libc_malloc(bytes);
  errno = ENOMEM;
  return nullptr;
}
void* calloc(size_t count, size_t bytes) {
  if (!loden::test::allocations.fails(nullptr)) return __libc_calloc(count, bytes);
  errno = ENOMEM;
  return nullptr;
}
void free(void* pointer) {
  loden::test::allocations.freed(pointer);
  __libc_free(pointer);
}
}
#else
__attribute__((noinline)) void* operator new(size_t bytes) {
  const bool fails = loden::test::allocations.fails(__builtin_return_address(0));
  void* pointer = fails ? nullptr : std::malloc(bytes ? bytes : 1);
  if (!pointer) throw std::bad_alloc();
  return pointer;
}
__attribute__((noinline)) void operator delete(void* pointer) noexcept {
  loden::test::allocations.freed(pointer);
  std::free(pointer);
}
__attribute__((noinline)) void operator delete(void* pointer, size_t) noexcept {
  operator delete(pointer);
}
#endif
