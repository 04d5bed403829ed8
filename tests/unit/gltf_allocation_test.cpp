// Every allocation of validating, packing and loading a scene fails in turn, alone and with all that follow:
// an issue that says so, or success. A program of its own, because it replaces operator new.
#include <dlfcn.h>
#include <execinfo.h>
#include <sys/wait.h>
#include <unistd.h>

#include <climits>
#include <cstdio>
#include <cstring>
#include <exception>
#include <string>
#include <vector>

#include "importer/gltf/pack.h"
#include "material/asset/asset.h"
#include "material/base/issues.h"
#include "runtime/scene/gltf_scene.h"
#include "tests/failing_allocation.h"
#include "tests/unit/material_fixtures.h"
#include "tests/unit/triangle_scene.h"

static thread_local bool counting = false;

bool loden::test::allocationCounts(const void*) {
  return counting;
}

namespace loden {
namespace {

namespace fs = std::filesystem;

// How one run ends. kLibrary: the program ends in the library that the test names.
enum Exit : char { kSuccess, kMemory, kOtherIssue, kThrown, kLibrary, kEnded };
constexpr int kExits = kEnded + 1;

// Of the process that runs the work.
int exits_pipe = -1;
const char* library = nullptr;

void tell(Exit exit) {
  if (::write(exits_pipe, &exit, 1) != 1) ::_exit(1);
}

bool standsIn(const char* name, void* const* frames, int count) {
  for (int i = 0; name && i < count; ++i) {
    Dl_info info;
    if (::dladdr(frames[i], &info) != 0 && info.dli_fname && std::strstr(info.dli_fname, name)) return true;
  }
  return false;
}

[[noreturn]] void atTerminate() {
  counting = false;
  void* frames[64];
  const int count = ::backtrace(frames, 64);
  const bool not_ours = standsIn(library, frames, count);
  if (!not_ours) ::backtrace_symbols_fd(frames, count, STDERR_FILENO);
  tell(not_ours ? kLibrary : kEnded);
  ::_exit(0);
}

template <class T>
int idOf(const Result<T>& result) {
  return result ? 0 : result.issue().id;
}

class GltfAllocation : public test::TriangleScene {
 protected:
  GltfAllocation() {
    nlohmann::json named = scene();
    named["nodes"][0]["name"] = "a node whose name is long enough to be allocated";
    scene_ = write("scene.gltf", named.dump());
    const auto asset = *serializeAsset(test::surfaceMaterial());
    write("cloth.loden", std::string(reinterpret_cast<const char*>(asset.data()), asset.size()));
  }

  // Runs `work`, which returns an issue's id or 0, with the allocation failing.
  template <class Work>
  static Exit runFailing(long n, long count, const Work& work) {
    int id = 0;
    test::allocations.begin(n, count), counting = true;
    try {
      id = work();
    } catch (...) {
      counting = false;
      return kThrown;
    }
    counting = false;
    if (id != 0 && id != issue_id::kMemory) std::fprintf(stderr, "allocation %ld: issue %d\n", n, id);
    return id == 0 ? kSuccess : id == issue_id::kMemory ? kMemory : kOtherIssue;
  }

  // The same for all from `first` on, in a process of its own, up to the one that ends it.
  template <class Work>
  std::vector<Exit> runInChild(long first, long all, long count, const Work& work) const {
    int ends[2];
    EXPECT_EQ(::pipe(ends), 0);
    const pid_t child = ::fork();
    if (child == 0) {
      exits_pipe = ends[1];
      std::set_terminate(atTerminate);
      for (long n = first; n < all; ++n) {
        prepare();
        tell(runFailing(n, count, work));
      }
      ::_exit(0);
    }
    ::close(ends[1]);
    std::vector<Exit> exits;
    Exit exit;
    while (::read(ends[0], &exit, 1) == 1) exits.push_back(exit);
    ::close(ends[0]);
    int status = 0;
    ::waitpid(child, &status, 0);
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) exits.push_back(kEnded);
    return exits;
  }

  // `not_ours`: part of the file name of the library in which the program ends `at_library` times, where only
  // one allocation fails, and which may say of it what it wants.
  template <class Work>
  void expectSurvived(const char* what, const Work& work, const char* not_ours = nullptr,
                      int at_library = 0) {
    library = not_ours;
    prepare();
    ASSERT_EQ(work(), 0);  // what is made once and kept
    prepare();
    test::allocations.begin(-1), counting = true;
    const int id = work();
    counting = false;
    const long all = test::allocations.made;
    ASSERT_EQ(id, 0);
    ASSERT_GT(all, 50);
    for (const bool all_that_follow : {false, true}) {
      const long count = all_that_follow ? LONG_MAX : 1;
      std::vector<Exit> exits;
      while (long(exits.size()) < all)
        for (const Exit exit : runInChild(long(exits.size()), all, count, work)) exits.push_back(exit);
      int counts[kExits] = {};
      for (size_t n = 0; n < exits.size(); ++n) {
        ++counts[exits[n]];
        const bool allowed = exits[n] == kSuccess || exits[n] == kMemory || exits[n] == kLibrary;
        EXPECT_TRUE(allowed || (not_ours && exits[n] == kOtherIssue))
            << what << ": allocation " << n << " of " << all
            << (all_that_follow ? " and all that follow" : "") << " ends with " << int(exits[n]);
      }
      std::printf("%s: %ld allocations%s: %d refused, %d not noticed, %d other issues, %d ends in %s\n", what,
                  all, all_that_follow ? " and all that follow" : "", counts[kMemory], counts[kSuccess],
                  counts[kOtherIssue], counts[kLibrary], not_ours ? not_ours : "libraries");
      EXPECT_GT(counts[kMemory], all / 8);
      if (!all_that_follow) {
        EXPECT_EQ(counts[kLibrary], at_library);
      }
    }
  }

  // An empty folder for what is written.
  void prepare() const {
    fs::remove_all(folder_ / "out");
    fs::create_directories(folder_ / "out");
  }

  importer::PackOptions packOptions() const {
    importer::PackOptions options;
    options.scene = scene_;
    options.asset = folder_ / "cloth.loden";
    options.output = folder_ / "out/scene.gltf";
    options.material = "cloth";
    return options;
  }

  fs::path scene_;
};

TEST_F(GltfAllocation, ValidatingAScene) {
  expectSurvived("validateGltf", [&] {
    const auto issues = importer::validateGltf(scene_);
    if (!issues) return issues.issue().id;
    for (const Issue& issue : *issues)
      if (issue.severity == Severity::kError) return issue.id;
    return 0;
  });
}

TEST_F(GltfAllocation, PackingAScene) {
  importer::PackOptions options = packOptions();
  expectSurvived("pack", [&] { return idOf(importer::pack(options)); });
  options.embed = true;
  expectSurvived("pack --embed", [&] { return idOf(importer::pack(options)); });
}

// Functions of OpenImageIO that must not throw allocate.
TEST_F(GltfAllocation, PackingASceneWithPictures) {
  importer::PackOptions options = packOptions();
  options.fit_fallback = true;
  expectSurvived(
      "pack --fit-fallback", [&] { return idOf(importer::pack(options)); }, "OpenImageIO", 2);
}

// tinygltf's JSON is nlohmann's, whose destructor allocates.
TEST_F(GltfAllocation, LoadingAScene) {
  const runtime::SceneOptions options;
  expectSurvived(
      "loadGltfScene", [&] { return idOf(runtime::loadGltfScene(scene_, options)); }, "tinygltf", 2);
}

}  // namespace
}  // namespace loden
