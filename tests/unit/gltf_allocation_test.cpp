// Every allocation of validating a scene fails in turn, each in a process of its own: an issue that says so,
// or success. A program of its own, because it replaces operator new.
#include <execinfo.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <new>
#include <string>
#include <vector>

#include "importer/gltf/pack.h"
#include "material/asset/asset.h"
#include "material/base/issues.h"
#include "tests/unit/material_fixtures.h"

extern "C" char __executable_start;  // of this program, where it is loaded

namespace {

thread_local bool counting = false;
thread_local long made = 0, fail_at = -1;

bool fails() {
  return counting && made++ == fail_at;
}

}  // namespace

__attribute__((noinline)) void* operator new(size_t bytes) {
  void* pointer = fails() ? nullptr : std::malloc(bytes ? bytes : 1);
  if (!pointer) throw std::bad_alloc();
  return pointer;
}
__attribute__((noinline)) void operator delete(void* pointer) noexcept {
  std::free(pointer);
}
__attribute__((noinline)) void operator delete(void* pointer, size_t) noexcept {
  std::free(pointer);
}

namespace loden {
namespace {

namespace fs = std::filesystem;

// How a process ends.
enum Exit { kSuccess, kMemory, kOtherIssue, kThrown, kJsonDestructor, kEnded };
constexpr int kExits = kEnded + 1;

// The destructor of a JSON value allocates, in nlohmann's library 3.11 at least, and whatever throws there
// ends the program: the one end that is not ours. Where that code lies, as nm tells.
struct CodeRange {
  uintptr_t begin = 0, end = 0;
};
std::vector<CodeRange> json_destructors;

void findJsonDestructors() {
  const std::string command = "nm -CS /proc/" + std::to_string(::getpid()) + "/exe";
  FILE* symbols = ::popen(command.c_str(), "r");
  char line[4096];
  while (symbols && std::fgets(line, sizeof line, symbols)) {
    unsigned long at = 0, size = 0;
    if (!std::strstr(line, "json_value::destroy(") || std::sscanf(line, "%lx %lx", &at, &size) != 2) continue;
    const uintptr_t begin = reinterpret_cast<uintptr_t>(&__executable_start) + at;
    json_destructors.push_back({begin, begin + size});
  }
  if (symbols) ::pclose(symbols);
}

[[noreturn]] void atTerminate() {
  counting = false;
  void* frames[64];
  const int count = ::backtrace(frames, 64);
  for (int i = 0; i < count; ++i)
    for (const CodeRange& range : json_destructors) {
      const auto at = reinterpret_cast<uintptr_t>(frames[i]);
      if (at > range.begin && at <= range.end) ::_exit(kJsonDestructor);
    }
  ::backtrace_symbols_fd(frames, count, STDERR_FILENO);
  ::_exit(kEnded);
}

template <class T>
int idOf(const Result<T>& result) {
  return result ? 0 : result.issue().id;
}

class GltfAllocation : public testing::Test {
 protected:
  static void SetUpTestSuite() { findJsonDestructors(); }
  GltfAllocation() : folder_(fs::temp_directory_path() / ("loden_alloc_" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
    std::string bytes;
    const auto add = [&](auto value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
    for (const float v : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 1.f}) add(v);
    for (const uint16_t v : {uint16_t(0), uint16_t(1), uint16_t(2), uint16_t(0)}) add(v);
    write("scene.bin", bytes);
    write("scene.gltf", R"({
      "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
      "nodes": [{"mesh": 0, "children": [1], "name": "a node whose name is long enough to be allocated"}, {}],
      "meshes": [{"primitives": [
        {"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
      "materials": [{"name": "cloth", "pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1]}}],
      "buffers": [{"uri": "scene.bin", "byteLength": 68}],
      "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 24},
                      {"buffer": 0, "byteOffset": 60, "byteLength": 8}],
      "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
                    {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"},
                    {"bufferView": 2, "componentType": 5123, "count": 3, "type": "SCALAR"}]})");
    const auto asset = *serializeAsset(test::surfaceMaterial());
    write("cloth.loden", std::string(reinterpret_cast<const char*>(asset.data()), asset.size()));
  }
  ~GltfAllocation() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
  }
  // Runs `work`, which returns an issue's id or 0, with one allocation failing, in a child.
  template <class Work>
  static Exit runFailing(long n, const Work& work) {
    const pid_t child = ::fork();
    if (child == 0) {
      std::set_terminate(atTerminate);
      int id = 0;
      made = 0, fail_at = n, counting = true;
      try {
        id = work();
      } catch (...) {
        counting = false;
        ::_exit(kThrown);
      }
      counting = false;
      if (id != 0 && id != issue_id::kMemory) std::fprintf(stderr, "allocation %ld: issue %d\n", n, id);
      ::_exit(id == 0 ? kSuccess : id == issue_id::kMemory ? kMemory : kOtherIssue);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFEXITED(status) && WEXITSTATUS(status) < kExits ? Exit(WEXITSTATUS(status)) : kEnded;
  }

  template <class Work>
  static void expectSurvived(const char* what, const Work& work) {
    ASSERT_EQ(work(), 0);  // what is made once and kept
    made = 0, fail_at = -1, counting = true;
    const int id = work();
    counting = false;
    const long all = made;
    ASSERT_EQ(id, 0);
    ASSERT_GT(all, 50);
    int exits[kExits] = {};
    for (long n = 0; n < all; ++n) {
      const Exit exit = runFailing(n, work);
      ++exits[exit];
      EXPECT_TRUE(exit == kSuccess || exit == kMemory || exit == kJsonDestructor)
          << what << ": allocation " << n << " of " << all << " ends with " << exit;
    }
    std::printf("%s: %ld allocations: %d refused, %d not noticed, %d in destructors of JSON values\n", what,
                all, exits[kMemory], exits[kSuccess], exits[kJsonDestructor]);
    EXPECT_GT(exits[kMemory], all / 4);
  }

  fs::path folder_;
};

TEST_F(GltfAllocation, ValidatingAScene) {
  const fs::path scene = folder_ / "scene.gltf";
  expectSurvived("validateGltf", [&] {
    const auto issues = importer::validateGltf(scene);
    if (!issues) return issues.issue().id;
    for (const Issue& issue : *issues)
      if (issue.severity == Severity::kError) return issue.id;
    return 0;
  });
}

}  // namespace
}  // namespace loden
