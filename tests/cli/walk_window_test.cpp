// loden_walk in a window on a display server of the test's own (Xvfb), driven by keys and mouse (xdotool) as
// a visitor does; what it then shows is what it saves.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>
#include <thread>

#include "runtime/scene/image_decode.h"
#include "runtime/scene/image_write.h"
#include "tests/cli/drop_files.h"
#include "tests/cli/loden_fixture.h"

namespace loden::test {
namespace {

using Json = nlohmann::json;
using namespace std::chrono_literals;

// A program that is ended with the object.
class Program {
 public:
  // `prepare` runs in the new process.
  template <class Prepare>
  Program(const std::vector<std::string>& words, const Prepare& prepare) {
    process_ = ::fork();
    if (process_ != 0) return;
    prepare();
    std::vector<char*> pointers;
    for (const std::string& word : words) pointers.push_back(const_cast<char*>(word.c_str()));
    pointers.push_back(nullptr);
    ::execvp(pointers[0], pointers.data());
    ::_exit(127);
  }
  ~Program() {
    if (process_ <= 0) return;
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  // Its exit code; -1 if it does not end in time.
  int wait(std::chrono::seconds most) {
    for (const auto end = std::chrono::steady_clock::now() + most; std::chrono::steady_clock::now() < end;) {
      int status = 0;
      if (::waitpid(process_, &status, WNOHANG) == process_) {
        process_ = -1;
        return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
      }
      std::this_thread::sleep_for(20ms);
    }
    return -1;
  }

 private:
  pid_t process_ = -1;
};

class WalkWindow : public ::testing::Test {
 protected:
  void SetUp() override {
    int ends[2];
    ASSERT_EQ(::pipe(ends), 0);
    server_ = std::make_unique<Program>(
        std::vector<std::string>{"Xvfb", "-displayfd", "9", "-screen", "0", "640x480x24"}, [&] {
          ::dup2(ends[1], 9);
          std::freopen("/dev/null", "w", stderr);
        });
    ::close(ends[1]);
    char number[16] = {};
    number[0] = ':';
    const bool served = ::read(ends[0], number + 1, sizeof number - 2) > 0;
    ::close(ends[0]);
    if (!served) GTEST_SKIP() << "Xvfb is not installed";
    number[1 + std::strspn(number + 1, "0123456789")] = 0;
    ::setenv("DISPLAY", number, 1);
    ::unsetenv("EGL_PLATFORM");
    if (std::system("command -v xdotool >/dev/null") != 0) GTEST_SKIP() << "xdotool is not installed";
  }

  void start(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), LODEN_WALK);
    walk_ = std::make_unique<Program>(arguments, [&] {
      if (::chdir(scratch_.path().c_str()) != 0) ::_exit(126);
    });
    act("search --sync --onlyvisible --name loden_walk");
    act("mousemove 200 150");
  }

  void act(const std::string& what) {
    const std::string command = "timeout 60 xdotool " + what + " >/dev/null 2>&1";
    EXPECT_EQ(std::system(command.c_str()), 0) << what;
  }

  // Files of the scratch folder onto the window.
  void drop(const std::vector<std::string>& names) {
    std::vector<std::filesystem::path> files;
    for (const std::string& name : names) files.push_back(scratch_ / name);
    EXPECT_EQ(dropFiles(std::getenv("DISPLAY"), files, 60s), "") << names.front();
  }

  // What the window shows, once it is whole.
  std::vector<glm::u8vec4> picture() {
    std::vector<glm::u8vec4> before, now = savedPicture();
    for (int i = 0; i < 60 && now != before; ++i) {
      std::this_thread::sleep_for(500ms);
      before = std::exchange(now, savedPicture());
    }
    return now;
  }

  std::vector<glm::u8vec4> savedPicture() {
    const auto file = scratch_ / ("loden_walk-" + std::to_string(++saved_) + ".png");
    act("key F12");
    std::vector<glm::u8vec4> pixels;
    for (int i = 0; i < 3000 && !std::filesystem::exists(file); ++i) std::this_thread::sleep_for(20ms);
    const std::string bytes = fileText(file);  // appears whole
    const auto image = runtime::decodeImage(std::as_bytes(std::span(bytes)), file.string());
    EXPECT_TRUE(image.ok()) << file;
    if (!image) return {};
    EXPECT_EQ(image->size, glm::ivec2(320, 240));
    return image->pixels;
  }

  static double difference(const std::vector<glm::u8vec4>& a, const std::vector<glm::u8vec4>& b) {
    if (a.size() != b.size() || a.empty()) return -1;
    double sum = 0;
    for (size_t i = 0; i < a.size(); ++i)
      for (int c = 0; c < 3; ++c) sum += std::abs(int(a[i][c]) - int(b[i][c]));
    return sum / double(3 * a.size());
  }

  ScratchFolder scratch_;
  std::unique_ptr<Program> server_, walk_;
  int saved_ = 0;
};

TEST_F(WalkWindow, KeysAndMouseDoWhatTheHelpSays) {
  start({sharedAsset(), "--size", "320x240", "--period", "30cm", "--report", "report.json"});
  const auto first = picture();
  act("mousedown 1 sleep 0.1 mousemove 260 170 sleep 0.1 mousemove 300 160 sleep 0.1 mouseup 1");  // orbit
  const auto turned = picture();
  EXPECT_GT(difference(first, turned), 2);
  act("click 4 click 4 click 4");  // wheel
  const auto near = picture();
  EXPECT_GT(difference(turned, near), 2);
  act("key s");  // a tap
  const auto back = picture();
  EXPECT_GT(difference(near, back), 0.1);
  act("key b");
  const auto own = picture();
  EXPECT_GT(difference(back, own), 1) << "glTF's own material";
  act("key b");
  EXPECT_EQ(difference(back, picture()), 0) << "and back";
  act("key x");
  EXPECT_GT(difference(back, picture()), 5) << "a heat map";
  act("key x key x key x key c");
  const auto wiped = picture();
  double left = 0, right = 0;
  for (size_t i = 0; i < wiped.size(); ++i)
    (i % 320 < 150 ? left : i % 320 > 170 ? right : left) += std::abs(int(wiped[i].g) - int(back[i].g));
  EXPECT_GT(left, 20 * right) << "the left half shows glTF's own material, the right half what there was";
  act("key c key h key Tab");
  EXPECT_EQ(difference(back, picture()), 0) << "help and panel are not part of the picture";
  act("key h key Tab");
  act("mousemove 160 120 click --repeat 2 --delay 80 1");  // double click
  EXPECT_GT(difference(back, picture()), 1);
  act("key Escape");
  EXPECT_EQ(walk_->wait(60s), 0);

  const Json report = Json::parse(fileText(scratch_ / "report.json"));
  EXPECT_EQ(report["schema"], "loden/walk/1");
  EXPECT_GT(report["frames"].size(), 20u);
  EXPECT_NEAR(report["camera"]["up"][1].get<double>(), 1, 1e-9);
}

// A panorama of one colour in Radiance's format, without run lengths.
void writeHdr(const std::filesystem::path& file, unsigned char red, unsigned char green, unsigned char blue) {
  std::string text = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n";
  for (int i = 0; i < 32; ++i)
    for (const unsigned char c : {red, green, blue, static_cast<unsigned char>(128)}) text += char(c);
  writeText(file, text);
}

// The scene of `folder` as one file.
void writeGlb(const std::filesystem::path& folder, const std::string& name) {
  Json json = Json::parse(fileText(folder / "scene.gltf"));
  json["buffers"][0].erase("uri");
  std::string text = json.dump(), bin = fileText(folder / "scene.bin");
  text.resize((text.size() + 3) / 4 * 4, ' ');
  bin.resize((bin.size() + 3) / 4 * 4, 0);
  std::string file = "glTF";
  const auto add = [&file](uint32_t value) {
    for (int k = 0; k < 4; ++k) file += static_cast<char>(value >> 8 * k);
  };
  add(2), add(static_cast<uint32_t>(12 + 8 + text.size() + 8 + bin.size()));
  add(static_cast<uint32_t>(text.size())), file += "JSON" + text;
  add(static_cast<uint32_t>(bin.size())), file += std::string("BIN\0", 4) + bin;
  writeText(folder / name, file);
}

TEST_F(WalkWindow, DroppedFilesAreTaken) {
  writeScene(scratch_.path());
  std::filesystem::rename(scratch_ / "scene.gltf", scratch_ / "a scene of 100 %.gltf");
  std::filesystem::copy_file(sharedAsset(), scratch_ / "cloth.loden");
  writeHdr(scratch_ / "red.hdr", 200, 20, 20);
  writeText(scratch_ / "notes.txt", "no file of ours");
  writeText(scratch_ / "damaged.gltf", "{");
  writeText(scratch_ / "damaged.loden", "LODEN");
  writeText(scratch_ / "damaged.hdr", "#?RADIANCE");
  start({sharedAsset(), "--size", "320x240", "--period", "30cm"});
  const auto first = picture();
  drop({"red.hdr"});
  const auto red = picture();
  EXPECT_GT(difference(first, red), 5) << "light";
  drop({"a scene of 100 %.gltf"});
  const auto triangle = picture();
  EXPECT_GT(difference(red, triangle), 5) << "a scene, whose name needs escapes in a URI";
  drop({"cloth.loden"});
  const auto dressed = picture();
  EXPECT_GT(difference(triangle, dressed), 1) << "onto the chosen material";
  drop({"notes.txt", "damaged.gltf", "damaged.loden", "damaged.hdr"});
  EXPECT_EQ(difference(dressed, picture()), 0) << "what cannot be taken changes nothing";
  act("key b");
  EXPECT_EQ(difference(triangle, picture()), 0) << "the dress was all that was new";
  act("key b");
  std::filesystem::rename(scratch_ / "a scene of 100 %.gltf", scratch_ / "scene.gltf");
  writeGlb(scratch_.path(), "scene.glb");
  std::filesystem::remove(scratch_ / "scene.gltf");
  std::filesystem::remove(scratch_ / "scene.bin");
  drop({"scene.glb"});
  EXPECT_EQ(difference(triangle, picture()), 0) << "the same scene, in its own materials again";
  drop({"scene.glb", "cloth.loden"});
  EXPECT_EQ(difference(dressed, picture()), 0) << "two files at once, one after the other";
  act("key Escape");
  EXPECT_EQ(walk_->wait(60s), 0);
}

// The truth here is a picture of stripes, which nothing else shows.
TEST_F(WalkWindow, TracedTruthIsShownFromItsOwnCameraAlone) {
  std::vector<glm::u8vec4> stripes;
  for (int i = 0; i < 320 * 240; ++i) stripes.emplace_back(i % 320, i / 320, i % 2 * 255, 255);
  ASSERT_TRUE(runtime::writePng(scratch_ / "truth.png", stripes, {320, 240}).ok());
  start({"--asset", sharedAsset(), "--size", "320x240", "--truth", (scratch_ / "truth.png").string()});
  const auto agreement = [&](const std::vector<glm::u8vec4>& shown, int from, int to) {
    int same = 0;
    for (int i = 0; i < 320 * 240; ++i)
      same += i % 320 >= from && i % 320 < to && shown[size_t(i)] == stripes[size_t(i)];
    return double(same) / (240 * (to - from));
  };
  const auto first = picture();
  ASSERT_EQ(first.size(), stripes.size());
  EXPECT_EQ(agreement(first, 0, 160), 1) << "left the truth, pixel by pixel";
  EXPECT_LT(agreement(first, 160, 320), 0.01) << "right what the asset looks like";
  act("click 4");  // wheel
  const auto nearer = picture();
  EXPECT_LT(agreement(nearer, 0, 160), 0.01) << "of another camera there is no truth";
  act("key p");
  const auto again = picture();
  EXPECT_EQ(agreement(again, 0, 160), 1) << "the truth shows where it was taken";
  EXPECT_LT(difference(first, again), 1e-3) << "but for what had not come to rest";
  act("key Escape");
  EXPECT_EQ(walk_->wait(60s), 0);
}

TEST_F(WalkWindow, ATruthOfOtherProportionsIsRefused) {
  ASSERT_TRUE(runtime::writePng(scratch_ / "truth.png", std::vector<glm::u8vec4>(16 * 16), {16, 16}).ok());
  const ToolRun run = runTool(LODEN_WALK, {"--asset", sharedAsset(), "--truth", scratch_ / "truth.png"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.err.find("16 x 16"), std::string::npos) << run.err;
  EXPECT_EQ(runTool(LODEN_WALK, {"--asset", sharedAsset(), "--truth", "none.png"}).exit_code, 2);
}

TEST_F(WalkWindow, ATapOfEscapeIsNeverLost) {
  for (int i = 0; i < 3; ++i) {
    start({sharedAsset(), "--size", "320x240", "-q"});
    act("key --delay 0 Escape");
    EXPECT_EQ(walk_->wait(60s), 0) << "time " << i;
  }
}

}  // namespace
}  // namespace loden::test
