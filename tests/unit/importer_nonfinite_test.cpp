// Input that is not finite: refused with count and first place, or repaired and reported.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "fit_synthetic.h"
#include "importer/bake/bake.h"
#include "importer/base/image_file.h"
#include "importer/base/repair_log.h"
#include "importer/btf/baked_files.h"
#include "importer/cook/cook.h"
#include "importer_meshes.h"
#include "material/base/issues.h"

namespace loden::importer {
namespace {

using testing::objGrid;
using testing::TemporaryFolder;

const float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();

TEST(RepairNonFinite, ValueBecomesTheMeanOfItsNeighboursAcrossTheBorder) {
  std::vector<float> values(16, 1.0f);  // 4 x 4, one layer, one channel
  values[0] = kNan, values[15] = 9;     // texel (3, 3) touches (0, 0) across both borders
  const NonFinite found = repairNonFinite(values, {1, 4, 4, 1});
  EXPECT_EQ(found.count, 1u);
  EXPECT_EQ(found.first, 0u);
  EXPECT_FLOAT_EQ(values[0], (7 * 1 + 9) / 8.0f);
}

TEST(RepairNonFinite, LayersAndChannelsAreNotMixed) {
  const MapShape shape{2, 3, 3, 2};
  std::vector<float> values(36);
  for (size_t i = 0; i < values.size(); ++i) values[i] = (i < 18 ? 1.0f : 10.0f) + (i % 2 ? 100.0f : 0.0f);
  values[18 + 4 * 2 + 1] = -kInf;  // layer 1, texel (1, 1), channel 1
  const NonFinite found = repairNonFinite(values, shape);
  EXPECT_FLOAT_EQ(values[18 + 4 * 2 + 1], 110);
  EXPECT_EQ(placeOf(found.first, shape, "light"), "light 1, texel (1, 1)");
}

TEST(RepairNonFinite, AreasFillFromTheirBorderAndEmptyLayersWithZero) {
  std::vector<float> area(64, 2.0f);
  for (int j = 1; j < 7; ++j)
    for (int i = 1; i < 7; ++i) area[size_t(j * 8 + i)] = kNan;
  EXPECT_EQ(repairNonFinite(area, {1, 8, 8, 1}).count, 36u);
  for (const float value : area) EXPECT_FLOAT_EQ(value, 2);
  std::vector<float> empty(9, kNan);
  EXPECT_EQ(repairNonFinite(empty, {1, 3, 3, 1}).count, 9u);
  for (const float value : empty) EXPECT_EQ(value, 0);
}

TEST(RepairLog, PartReadTwice_CountsOnce) {
  RepairLog log;
  EXPECT_EQ(log.count(), 0u);
  EXPECT_EQ(log.first(), "");
  log.add("view 0002", 3, "texel (0, 0)"), log.add("view 0001", 4, "texel (1, 0)"),
      log.add("view 0002", 3, "texel (0, 0)");
  log.add("view 0000", 0, "nowhere");
  EXPECT_EQ(log.count(), 7u);
  EXPECT_EQ(log.first(), "view 0001: texel (1, 0)");
}

// --- cook -------------------------------------------------------------------------------------------------

// A bake of a grooved tile with some of a map's values replaced.
class DamagedBake {
 public:
  DamagedBake() {
    BakeOptions options;
    options.size = 8;
    options.geometry_size = 32;
    options.directions = concentricDirections(3);
    options.quiet = true;
    EXPECT_TRUE(bake(testing::groovedTile(), "grooves", folder_.path(), options).ok());
  }
  const std::filesystem::path& folder() const { return folder_.path(); }
  void damage(const std::filesystem::path& file, PixelType type,
              const std::vector<std::pair<size_t, float>>& values) const {
    Image image = *readImage(file);
    for (const auto& [index, value] : values) image.pixels[index] = value;
    ASSERT_TRUE(writeImage(file, image.width, image.height, image.channels, type, image.pixels).ok());
  }

 private:
  TemporaryFolder folder_;
};

CookOptions cookOptions(Mode mode) {
  CookOptions options;
  options.mode = mode;
  options.quiet = true;
  return options;
}

double worstDifference(const Texture& a, const Texture& b) {
  double worst = 0;
  for (int j = 0; j < a.height; ++j)
    for (int i = 0; i < a.width; ++i) {
      const glm::vec4 d = glm::abs(fetchTexel(a, 0, i, j, 0) - fetchTexel(b, 0, i, j, 0));
      worst = std::max({worst, double(d.x), double(d.y), double(d.z)});
    }
  return worst;
}

TEST(CookNonFinite, GeometryIsRefusedWithCountAndPlaceOrRepaired) {
  const DamagedBake bake;
  const auto sound = cook(*BakedOutput::open(bake.folder()), cookOptions(Mode::kSurface));
  ASSERT_TRUE(sound.ok()) << sound.issue().text;
  const size_t texel = 4 * (5 * 32 + 7);
  bake.damage(surfacePath(bake.folder(), "geometry"), PixelType::kFloat,
              {{texel + 2, kNan}, {texel + 6, kInf}});

  const auto refused = cook(*BakedOutput::open(bake.folder()), cookOptions(Mode::kSurface));
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.issue().id, issue_id::kNonFinite);
  EXPECT_NE(refused.issue().text.find("2 values"), std::string::npos) << refused.issue().text;
  EXPECT_NE(refused.issue().text.find("texel (7, 5)"), std::string::npos) << refused.issue().text;

  const auto log = std::make_shared<RepairLog>();
  const auto repaired = cook(*BakedOutput::open(bake.folder(), log), cookOptions(Mode::kSurface));
  ASSERT_TRUE(repaired.ok()) << repaired.issue().text;
  EXPECT_EQ(log->count(), 2u);
  EXPECT_EQ(log->first(), "geometry: texel (7, 5)");
  // A groove is 16 texels wide and .2 deep: neighbours differ by .04 at most, which is .2 of the range.
  EXPECT_LE(worstDifference(sound->geometry.texels, repaired->geometry.texels), 0.2);
}

TEST(CookNonFinite, ChartThatIsNotFinite_IsNoSurface) {
  const DamagedBake bake;
  bake.damage(surfacePath(bake.folder(), "geometry"), PixelType::kFloat, {{4 * (5 * 32 + 7) + 3, kNan}});
  const auto texels = BakedOutput::open(bake.folder(), std::make_shared<RepairLog>())->geometry();
  ASSERT_TRUE(texels.ok());
  EXPECT_EQ((*texels)[5 * 32 + 7].w, 0);
  EXPECT_EQ((*texels)[5 * 32 + 8].w, 1);
}

TEST(CookNonFinite, BtfIsRefusedWithCountAndPlaceOrRepaired) {
  const DamagedBake bake;
  // View 4: light 0 is the first cell of an atlas of 3 x 3 cells, 8 x 8 texels each.
  bake.damage(btfPath(bake.folder(), 4), PixelType::kHalf,
              {{3 * (2 * 24 + 6), kNan}, {3 * (3 * 24 + 6) + 1, kInf}});
  for (const Mode mode :
       {Mode::kLod, Mode::kFused, Mode::kSurface}) {  // surface: the mean is fitted to the BTF
    const auto refused = cook(*BakedOutput::open(bake.folder()), cookOptions(mode));
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.issue().id, issue_id::kNonFinite);
    EXPECT_NE(refused.issue().text.find("view 4, the first at light 0, texel (6, 2)"), std::string::npos)
        << refused.issue().text;
    const auto log = std::make_shared<RepairLog>();
    const auto repaired = cook(*BakedOutput::open(bake.folder(), log), cookOptions(mode));
    ASSERT_TRUE(repaired.ok()) << repaired.issue().text;
    EXPECT_EQ(log->count(), 2u);
    EXPECT_EQ(log->first(), "view 0004: light 0, texel (6, 2)");
  }
}

// --- bake -------------------------------------------------------------------------------------------------

constexpr int kCells = 8;

std::string waveWith(const std::string& position, const std::string& uv) {
  std::string text = objGrid(
      kCells, [](glm::dvec2 q) { return glm::dvec3(q, 0.1 * std::sin(2 * kPi * q.x)); },
      [](glm::dvec2 q) { return q; });
  // Line of vertex (4, 4), inside the tile: a "v" and a "vt" line per vertex.
  size_t at = 0;
  for (int line = 0; line < 2 * (4 * (kCells + 1) + 4); ++line) at = text.find('\n', at) + 1;
  const size_t middle = text.find('\n', at) + 1, end = text.find('\n', middle) + 1;
  const std::string v = position.empty() ? text.substr(at, middle - at) : "v " + position + "\n";
  const std::string vt = uv.empty() ? text.substr(middle, end - middle) : "vt " + uv + "\n";
  return text.replace(at, end - at, v + vt);
}

TEST(BakeNonFinite, VerticesAreRefusedWithCountAndPlaceOrRepaired) {
  const TemporaryFolder folder;
  const std::string sound = folder.write("sound.obj", waveWith("", ""));
  const auto expected = loadTile(sound);
  ASSERT_TRUE(expected.ok()) << expected.issue().text;
  const std::vector<std::pair<std::string, std::string>> damages{
      {"0.5 nan 0", ""}, {"", "inf 0.5"}, {"nan nan nan", "nan nan"}};
  for (const auto& [position, uv] : damages) {
    const std::string path = folder.write("bad.obj", waveWith(position, uv));
    const auto refused = loadTile(path);
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.issue().id, issue_id::kTileNonFinite);
    EXPECT_NE(refused.issue().where.find("vertex"), std::string::npos);
    EXPECT_NE(refused.issue().text.find("1 of 81"), std::string::npos) << refused.issue().text;

    const auto log = std::make_shared<RepairLog>();
    const auto repaired = loadTile(path, {.repairs = log});
    ASSERT_TRUE(repaired.ok()) << repaired.issue().text;
    EXPECT_EQ(log->count(), 1u);
    ASSERT_EQ(repaired->positions.size(), expected->positions.size());
    // The wave is odd about this vertex, so the mean of its neighbours is the vertex itself.
    for (size_t v = 0; v < expected->positions.size(); ++v) {
      EXPECT_LT(glm::distance(repaired->positions[v], expected->positions[v]), 1e-9);
      EXPECT_LT(glm::distance(repaired->params[v], expected->params[v]), 1e-9);
    }
  }
}

TEST(BakeNonFinite, TextureCoordinatesOfATexturedGltf_AreNoIndexIntoItsPicture) {
  const TemporaryFolder folder;
  nlohmann::ordered_json json = testing::gltfTile();
  // A 1 x 1 white PNG.
  json["images"] = {{{"uri",
                      "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8/"
                      "5+hHgAHggJ/PchI7wAAAABJRU5ErkJggg=="}}};
  json["textures"] = {{{"source", 0}}};
  json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
  ASSERT_TRUE(loadTile(folder.write("sound.gltf", json.dump()).string()).ok());
  auto uri = json["buffers"][0]["uri"].get<std::string>();
  const size_t first_uv = uri.find(',') + 1 + 48 / 3 * 4;  // behind 48 bytes of positions
  ASSERT_EQ(uri.substr(first_uv, 8), "AAAAAAAA");
  json["buffers"][0]["uri"] = uri.replace(first_uv, 8, "AADAfwAA");  // 00 00 C0 7F: NaN
  const auto refused = loadTile(folder.write("bad.gltf", json.dump()).string());
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.issue().id, issue_id::kTileNonFinite);
}

}  // namespace
}  // namespace loden::importer
