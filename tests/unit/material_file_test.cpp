// Files: sources by range, and a writer that leaves nothing behind.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "material/asset/asset.h"
#include "material/base/issues.h"
#include "material/system/asset_io.h"
#include "material/system/atomic_file.h"
#include "tests/unit/material_fixtures.h"

namespace loden {
namespace {

namespace fs = std::filesystem;

class AssetOnDisk : public testing::Test {
 protected:
  AssetOnDisk() {
    std::string name = (fs::temp_directory_path() / "loden-test-XXXXXX").string();
    EXPECT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  ~AssetOnDisk() override { fs::remove_all(folder_); }

  int filesLeft() const {
    int count = 0;
    for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder_)) ++count;
    return count;
  }

  fs::path folder_;
};

TEST_F(AssetOnDisk, ReadsWhatItWrote) {
  const Material material = test::fusedMaterial();
  const fs::path path = folder_ / "cloth.loden";
  ASSERT_TRUE(writeAsset(material, path).ok());
  ASSERT_TRUE(writeAsset(material, path).ok()) << "over the file that stands there";
  EXPECT_EQ(filesLeft(), 1);
  const Result<Material> read = readAsset(path);
  ASSERT_TRUE(read.ok());
  test::expectSame(material, *read);
  EXPECT_NE(fs::status(path).permissions() & fs::perms::owner_read, fs::perms::none);
}

TEST_F(AssetOnDisk, NamesTheFileThatItCannotOpen) {
  const fs::path missing = folder_ / "missing.loden";
  const Result<Material> read = readAsset(missing);
  ASSERT_FALSE(read.ok());
  EXPECT_EQ(read.issue().id, issue_id::kCannotOpen);
  EXPECT_EQ(read.issue().where, missing.string());
  EXPECT_EQ(readAsset(folder_).issue().id, issue_id::kCannotOpen) << "a folder";
  const fs::path pipe = folder_ / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(readAsset(pipe).issue().id, issue_id::kCannotOpen) << "a pipe, without waiting for its writer";
}

TEST_F(AssetOnDisk, ReportsAFileThatShrinksBehindItsBack) {
  const fs::path path = folder_ / "cloth.loden";
  ASSERT_TRUE(writeAsset(test::fusedMaterial(), path).ok());
  auto source = openFileSource(path);
  ASSERT_TRUE(source.ok());
  const Result<AssetFile> file = AssetFile::open(std::move(*source), "cloth");
  ASSERT_TRUE(file.ok());
  fs::resize_file(path, 1000);
  EXPECT_EQ(file->loadBand(0).issue().id, issue_id::kCannotRead);
}

// What reads a file by ranges has the file that it opened: one that is replaced or removed stays as it was,
// one that is written over is found to be damaged.
TEST_F(AssetOnDisk, StaysAsItWasWhereItIsReplacedOrRemovedAndIsRefusedWhereItIsOverwritten) {
  const fs::path path = folder_ / "cloth.loden", other = folder_ / "other.loden";
  ASSERT_TRUE(writeAsset(test::fusedMaterial(), path).ok());
  const auto open = [&] { return AssetFile::open(*openFileSource(path), "cloth"); };
  const Result<AssetFile> replaced = open();
  ASSERT_TRUE(replaced.ok());
  ASSERT_TRUE(writeAsset(test::lodMaterial(), other).ok());
  fs::rename(other, path);
  const Result<Band> old_band = replaced->loadBand(0);
  ASSERT_TRUE(old_band.ok()) << old_band.issue().text;
  EXPECT_TRUE(old_band->table.data == test::fusedMaterial().bands[0].table.data);

  const Result<AssetFile> removed = open();
  ASSERT_TRUE(removed.ok());
  fs::remove(path);
  EXPECT_TRUE(removed->loadBand(0).ok());

  ASSERT_TRUE(writeAsset(test::fusedMaterial(), path).ok());
  const Result<AssetFile> overwritten = open();
  ASSERT_TRUE(overwritten.ok());
  std::fstream(path, std::ios::binary | std::ios::in | std::ios::out).seekp(0)
      << std::string(fs::file_size(path), 'x');
  EXPECT_EQ(overwritten->loadBand(0).issue().id, issue_id::kChunkChecksum);
}

TEST_F(AssetOnDisk, LeavesNothingBehindIfTheTargetIsAFolder) {
  fs::create_directory(folder_ / "cloth.loden");
  const Status written = writeAsset(test::fusedMaterial(), folder_ / "cloth.loden");
  ASSERT_FALSE(written.ok());
  EXPECT_EQ(written.issue().id, issue_id::kCannotWrite);
  EXPECT_EQ(filesLeft(), 1);
}

TEST_F(AssetOnDisk, CannotWriteIntoAFolderThatIsNotThere) {
  EXPECT_EQ(writeAsset(test::fusedMaterial(), folder_ / "none" / "cloth.loden").issue().id,
            issue_id::kCannotWrite);
}

TEST_F(AssetOnDisk, CannotWriteIntoAReadOnlyFolder) {
  if (geteuid() == 0) GTEST_SKIP() << "root may write anywhere";
  fs::permissions(folder_, fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_EQ(writeAsset(test::fusedMaterial(), folder_ / "cloth.loden").issue().id, issue_id::kCannotWrite);
  fs::permissions(folder_, fs::perms::owner_all);
  EXPECT_EQ(filesLeft(), 0);
}

// A limit on file size fails in the middle of the write, as a full disk does.
TEST_F(AssetOnDisk, KeepsTheOldFileIfTheDiskIsFull) {
  const fs::path path = folder_ / "cloth.loden";
  ASSERT_TRUE(writeAsset(test::fusedMaterial(), path).ok());
  const auto old_size = fs::file_size(path);
  rlimit old_limit{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &old_limit), 0);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit limit{100, old_limit.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
  const Status written = writeAsset(test::surfaceMaterial(), path);
  setrlimit(RLIMIT_FSIZE, &old_limit);
  std::signal(SIGXFSZ, old_handler);
  ASSERT_FALSE(written.ok());
  EXPECT_EQ(written.issue().id, issue_id::kCannotWrite);
  EXPECT_EQ(filesLeft(), 1);
  EXPECT_EQ(fs::file_size(path), old_size);
}

// A limit on file size whose signal is not ignored ends the process in the middle of the write.
TEST_F(AssetOnDisk, RemovesWhatAKilledWriterLeftWhenTheFileIsWrittenAgain) {
  const fs::path path = folder_ / "cloth.loden";
  const auto killed = [&] {
    const pid_t child = fork();
    if (child == 0) {
      const rlimit limit{100, 100};
      setrlimit(RLIMIT_FSIZE, &limit);
      std::signal(SIGXFSZ, SIG_DFL);
      (void)writeAsset(test::fusedMaterial(), path);
      _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return WIFSIGNALED(status);
  };
  ASSERT_TRUE(killed());
  EXPECT_EQ(filesLeft(), 1) << "the temporary file";
  ASSERT_TRUE(killed());
  EXPECT_EQ(filesLeft(), 1) << "of the second; that of the first is gone";
  ASSERT_TRUE(writeAsset(test::fusedMaterial(), path).ok());
  EXPECT_EQ(filesLeft(), 1) << "the asset";
  EXPECT_TRUE(fs::exists(path));
}

TEST_F(AssetOnDisk, WritersOfOneFileAtTheSameTimeDoNotMeet) {
  const fs::path path = folder_ / "text";
  std::vector<std::thread> writers;
  std::atomic<int> failed{0};
  for (int k = 0; k < 4; ++k)
    writers.emplace_back([&, k] {
      const std::string text(20000, static_cast<char>('a' + k));
      for (int n = 0; n < 25; ++n) failed += !writeFileAtomically(path, std::as_bytes(std::span(text)));
    });
  for (std::thread& writer : writers) writer.join();
  EXPECT_EQ(failed, 0);
  EXPECT_EQ(filesLeft(), 1);
  std::ifstream file(path);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  EXPECT_EQ(text, std::string(20000, text.at(0)));
}

TEST_F(AssetOnDisk, DoesNotReplaceAPipe) {
  const fs::path pipe = folder_ / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(writeAsset(test::fusedMaterial(), pipe).issue().id, issue_id::kCannotWrite);
  EXPECT_TRUE(fs::is_fifo(pipe));
  EXPECT_EQ(filesLeft(), 1);
}

TEST_F(AssetOnDisk, WritesNothingForAMaterialThatIsNotValid) {
  Material material = test::fusedMaterial();
  material.side = 0;
  const Status written = writeAsset(material, folder_ / "cloth.loden");
  EXPECT_EQ(written.issue().id, issue_id::kSide);
  EXPECT_NE(written.issue().where.find("cloth.loden"), std::string::npos);
  EXPECT_EQ(filesLeft(), 0);
}

}  // namespace
}  // namespace loden
