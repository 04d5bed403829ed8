// The arrows of ARCHITECTURE.md, held against every #include.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

const fs::path kRoot = fs::path(LODEN_TESTS_DIR).parent_path();

// Per room what stands to the right of its arrow.
std::map<std::string, std::vector<std::string>> arrowsOfPage() {
  std::map<std::string, std::vector<std::string>> arrows;
  std::ifstream page(kRoot / "ARCHITECTURE.md");
  bool in_list = false;
  for (std::string line; std::getline(page, line);) {
    if (line.rfind("```", 0) == 0) in_list = !in_list;
    std::istringstream words(line);
    std::string room, arrow, to;
    if (!in_list || !(words >> room >> arrow) || arrow != "->") continue;
    auto& right = arrows[room];
    while (words >> to) right.push_back(to);
  }
  return arrows;
}

void addReachable(const std::map<std::string, std::vector<std::string>>& arrows, const std::string& room,
                  std::set<std::string>& reached) {
  const auto found = arrows.find(room);
  if (found == arrows.end()) return;
  for (const std::string& next : found->second)
    if (reached.insert(next).second) addReachable(arrows, next, reached);
}

std::vector<fs::path> sources() {
  std::vector<fs::path> files;
  for (const char* top : {"shaders", "material", "importer", "runtime", "sample_game"})
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / top)) {
      const std::string extension = entry.path().extension();
      if (extension == ".h" || extension == ".cpp" || extension == ".glsl")
        files.push_back(fs::relative(entry.path(), kRoot));
    }
  return files;
}

// The room that an include names; "" for headers that are not the project's, and for files beside the
// includer.
std::string roomOfInclude(const std::string& line) {
  constexpr std::string_view kStart = "#include \"";
  if (line.rfind(kStart, 0) != 0) return "";
  const std::string path = line.substr(kStart.size(), line.find('"', kStart.size()) - kStart.size());
  return fs::path(path).parent_path().string();
}

TEST(Architecture, ArrowsRunOneWay) {
  const auto arrows = arrowsOfPage();
  ASSERT_GT(arrows.size(), 20u);
  for (const auto& [room, right] : arrows) {
    for (const std::string& to : right) EXPECT_TRUE(arrows.contains(to)) << room << " -> " << to;
    std::set<std::string> reached;
    addReachable(arrows, room, reached);
    EXPECT_FALSE(reached.contains(room)) << room << " leads back to itself";
  }
}

TEST(Architecture, EveryIncludeFollowsAnArrow) {
  const auto arrows = arrowsOfPage();
  for (const fs::path& file : sources()) {
    const std::string room = file.parent_path().string();
    EXPECT_TRUE(arrows.contains(room)) << file << " stands in a room that ARCHITECTURE.md does not list";
    std::set<std::string> allowed{room, ""};
    addReachable(arrows, room, allowed);
    std::ifstream in(kRoot / file);
    for (std::string line; std::getline(in, line);) {
      const std::string included = roomOfInclude(line);
      EXPECT_TRUE(allowed.contains(included)) << file << " includes from " << included << ": " << line;
    }
  }
}

}  // namespace
