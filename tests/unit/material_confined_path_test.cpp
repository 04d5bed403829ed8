#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "material/base/issues.h"
#include "material/system/confined_path.h"

namespace loden {
namespace {

namespace fs = std::filesystem;

// A folder "scene" with a file in it, and a file beside the folder.
class ConfinedPath : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "loden_confined_XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    root_ = name;
    fs::create_directories(root_ / "scene/maps");
    std::ofstream(root_ / "scene/maps/a b.png") << "x";
    std::ofstream(root_ / "secret") << "x";
  }
  void TearDown() override { fs::remove_all(root_); }
  Result<fs::path> find(std::string_view uri) const {
    return confinedPath(root_ / "scene", uri, "images[0].uri");
  }
  fs::path root_;
};

TEST_F(ConfinedPath, FilesInTheFolderAreFound) {
  for (const char* uri : {"maps/a%20b.png", "./maps/a b.png", "maps/../maps/a%20b.png", "maps//a%20b.png"}) {
    const auto path = find(uri);
    ASSERT_TRUE(path.ok()) << uri;
    EXPECT_TRUE(fs::equivalent(*path, root_ / "scene/maps/a b.png")) << uri;
  }
  EXPECT_TRUE(find("not/there.png").ok()) << "whether it exists is not asked";
}

TEST_F(ConfinedPath, OthersAreRefusedWithTheirPlace) {
  using namespace std::string_view_literals;
  const auto expectAll = [&](int id, std::initializer_list<std::string_view> uris) {
    for (const std::string_view uri : uris) {
      const auto path = find(uri);
      ASSERT_FALSE(path.ok()) << uri;
      EXPECT_EQ(path.issue().id, id) << uri;
      EXPECT_EQ(path.issue().where, "images[0].uri");
    }
  };
  expectAll(issue_id::kGltfPath, {"../secret"sv, "maps/../../secret"sv, "%2e%2e/secret"sv, "."sv});
  expectAll(issue_id::kUriAbsolute,
            {"/etc/passwd"sv, "%2Fetc/passwd"sv, "file:secret"sv, "http://host/a.png"sv, "C:/a.png"sv});
  expectAll(issue_id::kUriSyntax, {"maps\\a.png"sv, "maps%5Ca.png"sv, "a%00b"sv, "a%2"sv, "a%zz"sv, ""sv});
}

TEST_F(ConfinedPath, LinksThatLeadOutAreRefused) {
  fs::create_symlink(root_ / "secret", root_ / "scene/link");
  fs::create_directory_symlink(root_, root_ / "scene/up");
  fs::create_symlink(root_ / "scene/maps/a b.png", root_ / "scene/inner");
  EXPECT_FALSE(find("link").ok());
  EXPECT_FALSE(find("up/secret").ok());
  EXPECT_TRUE(find("inner").ok());
}

}  // namespace
}  // namespace loden
