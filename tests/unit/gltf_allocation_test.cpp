// Every allocation of validating a scene fails in turn, each in a process of its own: an issue that says so,
// or success. A program of its own, because it replaces operator new.
#include <execinfo.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <string>
#include <vector>

#include "importer/gltf/pack.h"
#include "material/base/issues.h"
#include "tests/failing_allocation.h"
#include "tests/unit/triangle_scene.h"

extern "C" char __executable_start;  // of this program, where it is loaded

static thread_local bool counting = false;

bool loden::test::allocationCounts(const void*) {
  return counting;
}

namespace loden {
namespace {

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

class GltfAllocation : public test::TriangleScene {
 protected:
  static void SetUpTestSuite() { findJsonDestructors(); }
  // Runs `work`, which returns an issue's id or 0, with one allocation failing, in a child.
  template <class Work>
  static Exit runFailing(long n, const Work& work) {
    const pid_t child = ::fork();
    if (child == 0) {
      std::set_terminate(atTerminate);
      int id = 0;
      test::allocations.begin(n), counting = true;
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
    test::allocations.begin(-1), counting = true;
    const int id = work();
    counting = false;
    const long all = test::allocations.made;
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
};

TEST_F(GltfAllocation, ValidatingAScene) {
  nlohmann::json named = scene();
  named["nodes"][0]["name"] = "a node whose name is long enough to be allocated";
  const std::filesystem::path path = write("scene.gltf", named.dump());
  expectSurvived("validateGltf", [&] {
    const auto issues = importer::validateGltf(path);
    if (!issues) return issues.issue().id;
    for (const Issue& issue : *issues)
      if (issue.severity == Severity::kError) return issue.id;
    return 0;
  });
}

}  // namespace
}  // namespace loden
