// Textured materials of tiles: what a ray meets, from the file to the hit.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "importer/bake/bake_folder.h"
#include "importer/tile/tile_tracer.h"
#include "importer/trace/bent_tiles.h"
#include "importer_meshes.h"
#include "material/base/issues.h"
#include "material/model/color.h"

namespace loden::importer {
namespace {

using Json = nlohmann::ordered_json;
using testing::gltfTile;
using testing::objGrid;
using testing::TemporaryFolder;

// PNGs of 2 x 1 texels in RGB; the codes stand above each.
// 255 0 0, 0 255 0
constexpr const char* kRedGreen =
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAIAAAB7QOjdAAAAD0lEQVR42mP4z8DA8J8BAAf/Af+4BDXgAAAAAElFTkSuQmCC";
// 255 0 0, 0 254 0
constexpr const char* kRedAlmostGreen =
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAIAAAB7QOjdAAAAD0lEQVR42mP4z8DA8I8BAAf9Af6rWU3WAAAAAElFTkSuQmCC";
// 0 0 0, 0 128 255
constexpr const char* kSmoothMetal =
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAIAAAB7QOjdAAAADUlEQVR42mNgAIKG/wACBgGASGE4LAAAAABJRU5ErkJggg==";
// 16 bit: 65535 0 0, 0 32768 0
constexpr const char* kWide =
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABEAIAAAAr0DSeAAAAEElEQVR42mP4/58BDBqAGAAY9gJ/mPSaoAAAAABJRU5ErkJggg==";
// 16384 x 16384 by its header, without any texel
constexpr const char* kHuge =
    "iVBORw0KGgoAAAANSUhEUgAAQAAAAEAACAIAAAAmqofT"
    "AAAACElEQVR4nAMAAAAAAUgGidIAAAAASUVORK5CYII=";

constexpr int kNearest = 9728, kRepeat = 10497, kClamp = 33071, kMirror = 33648;  // glTF's own numbers

Json gltfSampler(int filter, int wrap) {
  return {{"magFilter", filter}, {"wrapS", wrap}, {"wrapT", wrap}};
}

void addTexture(Json& json, const char* png, const Json& sampler, const char* member,
                const Json& info = Json::object()) {
  const auto index = json.contains("textures") ? json["textures"].size() : size_t(0);
  json["images"].push_back({{"uri", std::string("data:image/png;base64,") + png}});
  json["samplers"].push_back(sampler);
  json["textures"].push_back({{"source", index}, {"sampler", index}});
  Json& texture = json["materials"][0]["pbrMetallicRoughness"][member] = info;
  texture["index"] = index;
}

// Dielectric, white, rough, red for u < .5 and green beyond.
Json checkerTile(const Json& sampler = gltfSampler(kNearest, kRepeat), const Json& info = Json::object()) {
  Json json = gltfTile();
  json["materials"][0]["pbrMetallicRoughness"] = {{"metallicFactor", 0}};
  addTexture(json, kRedGreen, sampler, "baseColorTexture", info);
  return json;
}

// Vertices with two sets of texture coordinates, v up in the first as in OBJ files: the tile's parameters are
// u, v.
struct Vertex {
  glm::vec3 position;  // z up
  glm::vec2 params, picture;
};

// The checker on these triangles, laid out by TEXCOORD_1.
Json meshTile(const std::vector<Vertex>& vertices, const std::vector<uint32_t>& corners,
              bool with_params = true) {
  Json json = checkerTile(gltfSampler(kNearest, kRepeat), {{"texCoord", 1}});
  std::string bytes;
  const auto view = [&](const void* data, size_t size) {
    json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", size}});
    bytes.append(static_cast<const char*>(data), size);
  };
  std::vector<glm::vec3> positions;
  std::vector<glm::vec2> sets[2];
  for (const Vertex& v : vertices) {
    positions.push_back({v.position.x, v.position.z, -v.position.y});
    sets[0].push_back({v.params.x, 1 - v.params.y}), sets[1].push_back(v.picture);
  }
  json["bufferViews"] = Json::array(), json["accessors"] = Json::array();
  view(positions.data(), positions.size() * sizeof(glm::vec3));
  for (const auto& set : sets) view(set.data(), set.size() * sizeof(glm::vec2));
  view(corners.data(), corners.size() * sizeof(uint32_t));
  json["accessors"] = {
      {{"bufferView", 0}, {"componentType", 5126}, {"count", vertices.size()}, {"type", "VEC3"}},
      {{"bufferView", 1}, {"componentType", 5126}, {"count", vertices.size()}, {"type", "VEC2"}},
      {{"bufferView", 2}, {"componentType", 5126}, {"count", vertices.size()}, {"type", "VEC2"}},
      {{"bufferView", 3}, {"componentType", 5125}, {"count", corners.size()}, {"type", "SCALAR"}}};
  json["meshes"][0]["primitives"][0]["attributes"] = {{"POSITION", 0}, {"TEXCOORD_1", 2}};
  if (with_params) json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = 1;
  json["meshes"][0]["primitives"][0]["indices"] = 3;
  json["buffers"] = {
      {{"byteLength", bytes.size()}, {"uri", "data:application/octet-stream;base64," + base64(bytes)}}};
  return json;
}

// A grid whose left and right halves share no vertices; `picture` of position and half.
void addGrid(int n, float height, const std::function<glm::vec2(glm::vec2, int)>& picture,
             std::vector<Vertex>& vertices, std::vector<uint32_t>& corners) {
  for (int half = 0; half < 2; ++half) {
    const auto first = uint32_t(vertices.size()), row = uint32_t(n / 2 + 1);
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n / 2; ++i) {
        const glm::vec2 q = glm::vec2(i + half * n / 2, j) / float(n);
        vertices.push_back({{q, height}, q, picture(q, half)});
      }
    for (uint32_t j = 0; j < uint32_t(n); ++j)
      for (uint32_t i = 0; i + 1 < row; ++i) {
        const uint32_t a = first + j * row + i;
        corners.insert(corners.end(), {a, a + 1, a + row + 1, a, a + row + 1, a + row});
      }
  }
}

Result<Tile> load(const Json& json, const TileOptions& options = {}) {
  const TemporaryFolder folder;
  return loadTile(folder.write("t.gltf", json.dump()).string(), options);
}

LocalBrdf brdfBelow(const Tile& tile, glm::dvec2 x) {
  const auto hit = TileTracer(tile).intersectView(x, {0, 0, 1});
  return hit ? hit->brdf : LocalBrdf{glm::vec3(std::nanf(""))};
}
glm::vec3 colorBelow(const Json& json, glm::dvec2 x) {
  const auto tile = load(json);
  if (!tile) ADD_FAILURE() << tile.issue().where << ": " << tile.issue().text;
  return tile ? brdfBelow(*tile, x).diffuse : glm::vec3(std::nanf(""));
}
constexpr float kRounding = 1e-6f;  // of a few float operations on values up to 1
void expectColor(const glm::vec3& color, const glm::vec3& expected) {
  EXPECT_LT(glm::distance(color, expected), kRounding) << color.r << ' ' << color.g << ' ' << color.b;
}
const glm::vec3 kRed(1, 0, 0), kGreen(0, 1, 0);

TEST(TileTexture, TwoTexelsOnOneQuadMeetAtASharpEdge) {
  const auto tile = load(checkerTile());
  ASSERT_TRUE(tile.ok()) << tile.issue().where << ": " << tile.issue().text;
  EXPECT_EQ(tile->triangles.size(), 2u);
  for (const double y : {0.1, 0.45, 0.8}) {
    expectColor(brdfBelow(*tile, {0.499, y}).diffuse, kRed);
    expectColor(brdfBelow(*tile, {0.501, y}).diffuse, kGreen);
  }
}

TEST(TileTexture, BentTilesShowTheSame) {
  const auto tile = load(checkerTile());
  ASSERT_TRUE(tile.ok());
  const AnalyticSurface sphere = analyticSurface(SurfaceKind::kSphere);
  const BentTiles tiles(*tile, sphere);
  int red = 0, green = 0;
  for (int k = 0; k < 40; ++k) {
    const SurfaceFrame frame = surfaceFrame(sphere, {0.2 + 0.0137 * k, 0.52});
    const auto hit = tiles.intersect(frame.position + frame.normal, -frame.normal);
    ASSERT_TRUE(hit);
    const double u = hit->tile_position.x - std::floor(hit->tile_position.x);
    expectColor(hit->brdf.diffuse, u < 0.5 ? kRed : kGreen);
    ++(u < 0.5 ? red : green);
  }
  EXPECT_GT(std::min(red, green), 5);
}

// A tile of a glTF file stands one period below that of an OBJ file, and its normals are rounded.
TEST(BentTiles, CoverCurvedSurfacesFromPoleToPoleWhereverTheTileStands) {
  Tile tile = *load(checkerTile());
  for (const double period : {-3.0, -1.0, -0.5, 0.0, 2.0}) {
    Tile moved = tile;
    for (glm::dvec3& p : moved.positions) p.y += period;
    for (glm::dvec3& n : moved.normals) n = glm::normalize(n + glm::dvec3(1e-8, 1e-8, 0));
    for (const SurfaceKind kind : {SurfaceKind::kSphere, SurfaceKind::kCylinder}) {
      if (kind == SurfaceKind::kCylinder && period == -0.5) continue;  // its ends would cut the two triangles
      const AnalyticSurface surface = analyticSurface(kind);
      const BentTiles tiles(moved, surface);
      for (int k = 0; k <= 60; ++k) {
        const SurfaceFrame frame = surfaceFrame(surface, {0.2137, (k + 0.01) / 60.02});
        const auto hit = tiles.intersect(frame.position + frame.normal, -frame.normal);
        ASSERT_TRUE(hit) << period << ", " << k;
        EXPECT_LT(glm::distance(hit->normal, frame.normal), 0.02) << period << ", " << k;
      }
      if (kind == SurfaceKind::kCylinder) {  // and not beyond its ends
        EXPECT_FALSE(tiles.intersect({-1, 0, 1.07}, {1, 0, 0}));
      }
    }
  }
}

TEST(TileTexture, IsBilinearInLinearLight) {
  Json json = checkerTile(Json::object());
  expectColor(colorBelow(json, {0.25, 0.3}), kRed);
  expectColor(colorBelow(json, {0.5, 0.3}), {0.5f, 0.5f, 0});
  expectColor(colorBelow(json, {0.375, 0.3}), {0.75f, 0.25f, 0});
  json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {0.5, 0.25, 1, 1};
  expectColor(colorBelow(json, {0.375, 0.3}), {0.375f, 0.0625f, 0});
  json["images"][0]["uri"] = std::string("data:image/png;base64,") + kWide;
  expectColor(colorBelow(json, {0.75, 0.3}), {0, 0.25f * float(linearFromSrgb(32768 / 65535.0)), 0});
}

TEST(TileTexture, MetalAndRoughnessAreReadAtTheHit) {
  Json json = gltfTile();
  json["materials"][0]["pbrMetallicRoughness"] = {{"baseColorFactor", {0.5, 0.25, 0.125, 1}}};
  addTexture(json, kSmoothMetal, gltfSampler(kNearest, kRepeat), "metallicRoughnessTexture");
  const auto tile = load(json);
  ASSERT_TRUE(tile.ok()) << tile.issue().where << ": " << tile.issue().text;
  const LocalBrdf smooth = brdfBelow(*tile, {0.3, 0.3}), metal = brdfBelow(*tile, {0.7, 0.3});
  expectColor(smooth.diffuse, {0.5f, 0.25f, 0.125f});
  expectColor(smooth.f0, glm::vec3(0.04f));
  EXPECT_LT(smooth.alpha, 0.05f);  // as narrow as lobes get
  expectColor(metal.diffuse, glm::vec3(0));
  expectColor(metal.f0, {0.5f, 0.25f, 0.125f});
  EXPECT_NEAR(metal.alpha, std::pow(128 / 255.0, 2), kRounding);  // linear, not sRGB
}

TEST(TileTexture, FollowsTextureTransformAndSet) {
  const auto with = [](const Json& transform) {
    Json json =
        checkerTile(gltfSampler(kNearest, kRepeat), {{"extensions", {{"KHR_texture_transform", transform}}}});
    json["extensionsUsed"] = json["extensionsRequired"] = {"KHR_texture_transform"};
    return json;
  };
  expectColor(colorBelow(with(Json::object()), {0.3, 0.1}), kRed);
  expectColor(colorBelow(with({{"offset", {0.5, 0}}}), {0.3, 0.1}), kGreen);
  expectColor(colorBelow(with({{"scale", {2, 1}}}), {0.3, 0.1}), kGreen);
  // A quarter turn: u' = v, v' = -u, with v = 1 - y (as in Blender, Babylon and Khronos'
  // TextureTransformTest).
  expectColor(colorBelow(with({{"rotation", kPi / 2}}), {0.3, 0.9}), kRed);
  expectColor(colorBelow(with({{"rotation", kPi / 2}}), {0.7, 0.1}), kGreen);
  // Scaled first, then turned, then moved: u' = 2 v + .75.
  expectColor(
      colorBelow(with({{"rotation", kPi / 2}, {"scale", {1, 2}}, {"offset", {0.75, 0}}}), {0.3, 0.95}),
      kGreen);
  expectColor(colorBelow(with({{"rotation", kPi / 2}, {"scale", {1, 2}}, {"offset", {0.75, 0}}}), {0.3, 0.8}),
              kRed);

  Json json = with({{"texCoord", 1}});  // in place of set 0
  EXPECT_EQ(load(json).issue().id, issue_id::kGltfAccessor);
  json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = 1;
  expectColor(colorBelow(json, {0.3, 0.1}), kRed);
  for (const Json& bad : {Json{{"offset", {1}}}, Json{{"scale", "wide"}}, Json{{"rotation", "left"}},
                          Json{{"scale", {1e30, 1}}}, Json{{"texCoord", -1}}})
    EXPECT_EQ(load(with(bad)).issue().id, issue_id::kTileMaterial) << bad;
}

TEST(TileTexture, WrapsAsItsSamplerSays) {
  TileTexture texture{2, 1, {kRed, kGreen}, TileTexture::Wrap::kRepeat, TileTexture::Wrap::kRepeat, true};
  const auto row = [&](TileTexture::Wrap wrap) {
    texture.wrap_u = texture.wrap_v = wrap;
    std::string colors;
    for (const double u : {-0.75, -0.25, 0.25, 0.75, 1.25, 1.75, 2.25})
      colors += sampleTexture(texture, {u, -7.3}) == kRed ? 'r' : 'g';
    return colors;
  };
  EXPECT_EQ(row(TileTexture::Wrap::kRepeat), "rgrgrgr");
  EXPECT_EQ(row(TileTexture::Wrap::kClamp), "rrrgggg");
  EXPECT_EQ(row(TileTexture::Wrap::kMirror), "grrggrr");
  texture.nearest = false;  // across the border: to the other side, or to itself
  texture.wrap_u = TileTexture::Wrap::kRepeat;
  EXPECT_EQ(sampleTexture(texture, {1, 0}), (kRed + kGreen) / 2.0f);
  texture.wrap_u = TileTexture::Wrap::kMirror;
  EXPECT_EQ(sampleTexture(texture, {1, 0}), kGreen);
  for (const double far : {1e9, -1e17, 1e300}) EXPECT_LE(glm::length(sampleTexture(texture, {far, -far})), 1);

  const Json twice{{"extensions", {{"KHR_texture_transform", {{"scale", {2, 1}}}}}}};
  expectColor(colorBelow(checkerTile(gltfSampler(kNearest, kRepeat), twice), {0.6, 0.3}), kRed);
  expectColor(colorBelow(checkerTile(gltfSampler(kNearest, kClamp), twice), {0.6, 0.3}), kGreen);
  expectColor(colorBelow(checkerTile(gltfSampler(kNearest, kMirror), twice), {0.9, 0.3}), kRed);
  EXPECT_EQ(load(checkerTile(gltfSampler(kNearest, 7))).issue().id, issue_id::kTileMaterial);
}

TEST(TileTexture, StaysWhereItIsWhenTheMeshIsSubdivided) {
  std::vector<Vertex> vertices;
  std::vector<uint32_t> corners;
  // Three pictures to the left; to the right they run the other way: a seam within the surface.
  addGrid(
      4, 0, [](glm::vec2 q, int half) { return glm::vec2(half == 0 ? 3 * q.x : 5 - 3 * q.x, q.y); }, vertices,
      corners);
  const auto tile = load(meshTile(vertices, corners), {2});
  ASSERT_TRUE(tile.ok()) << tile.issue().where << ": " << tile.issue().text;
  EXPECT_EQ(tile->triangles.size(), 2u * 16 * 16);
  const TileTracer tracer(*tile);
  for (int k = 0; k < 60; ++k) {
    const double x = (k + 0.37) / 60, u = x < 0.5 ? 3 * x : 5 - 3 * x;
    if (std::abs(2 * u - std::round(2 * u)) < 1e-3) continue;  // OpenSubdiv's weights are float
    const auto hit = tracer.intersectView({x, 0.017 * k}, {0, 0, 1});
    ASSERT_TRUE(hit);
    expectColor(hit->brdf.diffuse, u - std::floor(u) < 0.5 ? kRed : kGreen);
  }
}

TEST(TileTexture, StaysWhereItIsWhenAnOpenEdgeIsSplit) {
  // The triangle below the diagonal has a vertex of its neighbours on its long edge, and coordinates of its
  // own.
  const glm::vec2 off(3.5f, 0);
  std::vector<Vertex> vertices;
  for (const glm::vec2 q : {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(1, 1)})
    vertices.push_back({{q, 0}, q, q + off});
  for (const glm::vec2 q : {glm::vec2(0, 0), glm::vec2(0.25, 0.25), glm::vec2(1, 1), glm::vec2(0, 1)})
    vertices.push_back({{q, 0}, q, q});
  const auto tile = load(meshTile(vertices, {0, 1, 2, 3, 4, 6, 4, 5, 6}));
  ASSERT_TRUE(tile.ok()) << tile.issue().where << ": " << tile.issue().text;
  EXPECT_EQ(tile->triangles.size(), 4u);
  for (const double x : {0.2, 0.45, 0.55, 0.8}) {
    expectColor(brdfBelow(*tile, {x, x - 0.03}).diffuse, x < 0.5 ? kGreen : kRed);
    expectColor(brdfBelow(*tile, {x, x + 0.03}).diffuse, x < 0.5 ? kRed : kGreen);
  }
}

TEST(TileTexture, StaysWhereItIsWhenParametersAreMade) {
  std::vector<Vertex> vertices;
  std::vector<uint32_t> corners;
  const auto along_x = [](glm::vec2 q, int) { return q; };
  addGrid(8, 0, along_x, vertices, corners);
  for (const bool two_sheets : {false, true}) {
    if (two_sheets) addGrid(8, -0.3f, along_x, vertices, corners);  // several pieces: charts
    const auto tile = load(meshTile(vertices, corners, false));
    ASSERT_TRUE(tile.ok()) << tile.issue().where << ": " << tile.issue().text;
    const double origin = tile->positions[0].x - double(tile->texture_points[0].base_color.x);
    const TileTracer tracer(*tile);
    for (int k = 0; k < 20; ++k) {
      const auto hit = tracer.intersectView({(k + 0.3) / 20, 0.041 * k}, {0, 0, 1});
      ASSERT_TRUE(hit);
      const double u = hit->position.x - origin;
      expectColor(hit->brdf.diffuse, u - std::floor(u) < 0.5 ? kRed : kGreen);
    }
  }
}

TEST(TileTexture, IsPartOfTheTilesHash) {
  const auto hash = [](const Json& json) { return tileHash(*load(json)); };
  const std::string checker = hash(checkerTile());
  EXPECT_EQ(hash(checkerTile()), checker);
  Json json = checkerTile();
  json["images"][0]["uri"] = std::string("data:image/png;base64,") + kRedAlmostGreen;
  EXPECT_NE(hash(json), checker);
  EXPECT_NE(hash(checkerTile(gltfSampler(kNearest, kClamp))), checker);
  EXPECT_NE(hash(checkerTile(gltfSampler(kNearest, kRepeat),
                             {{"extensions", {{"KHR_texture_transform", {{"offset", {0.5, 0}}}}}}})),
            checker);
  json = checkerTile();
  json["materials"][0]["pbrMetallicRoughness"]["roughnessFactor"] = 0.5;
  EXPECT_NE(hash(json), checker);
}

TEST(TileTexture, RefusesWhatCannotBeRead) {
  Json json = checkerTile();
  json["images"][0]["uri"] = "missing.png";
  const auto missing = load(json);
  ASSERT_FALSE(missing.ok());
  EXPECT_EQ(missing.issue().id, issue_id::kTileMaterial);
  EXPECT_NE(missing.issue().text.find("missing.png"), std::string::npos);
  json = checkerTile();
  json["textures"][0].erase("source");
  EXPECT_EQ(load(json).issue().id, issue_id::kTileMaterial);
  json = checkerTile();
  json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 3;
  EXPECT_EQ(load(json).issue().id, issue_id::kTileMaterial);
  json = checkerTile();
  json["textures"][0]["sampler"] = 3;
  EXPECT_EQ(load(json).issue().id, issue_id::kTileMaterial);
}

TEST(TileMaterialWarnings, NameWhatIsNotBakedOnceEach) {
  EXPECT_TRUE(load(checkerTile())->warnings.empty());
  Json json = checkerTile();
  Json& material = json["materials"][0];
  material["name"] = "Linen";
  material["normalTexture"] = material["occlusionTexture"] = material["emissiveTexture"] = {{"index", 0}};
  material["alphaMode"] = "MASK";
  material["extensions"]["KHR_materials_sheen"] = Json::object();
  json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = 0;
  const auto tile = load(json);
  ASSERT_TRUE(tile.ok()) << tile.issue().where << ": " << tile.issue().text;
  for (const char* what :
       {"normalTexture", "occlusionTexture", "emissive", "alphaMode MASK", "KHR_materials_sheen", "COLOR_0"})
    EXPECT_EQ(std::count_if(tile->warnings.begin(), tile->warnings.end(),
                            [&](const Issue& issue) { return issue.text.find(what) != std::string::npos; }),
              1)
        << what;
  for (const Issue& issue : tile->warnings) {
    EXPECT_EQ(issue.severity, Severity::kWarning);
    EXPECT_NE(issue.where.find("'Linen'"), std::string::npos) << issue.where;
  }
}

TEST(TileMaterialRanges, AreThoseOfGltf) {
  const auto refusal = [](const char* member, const Json& value) {
    Json json = gltfTile();
    json["materials"][0]["name"] = "Linen";
    json["materials"][0]["pbrMetallicRoughness"][member] = value;
    const auto tile = load(json);
    return tile.ok() ? Issue{} : tile.issue();
  };
  const std::pair<const char*, Json> bad[] = {
      {"metallicFactor", -3}, {"metallicFactor", 1.5},           {"roughnessFactor", -2},
      {"roughnessFactor", 2}, {"baseColorFactor", {5, 0, 0, 1}}, {"baseColorFactor", {0, -0.5, 0, 1}}};
  for (const auto& [member, value] : bad) {
    const Issue issue = refusal(member, value);
    EXPECT_EQ(issue.id, issue_id::kTileMaterial) << member << value;
    EXPECT_NE(issue.where.find("t.gltf: material 0 'Linen'"), std::string::npos) << issue.where;
    EXPECT_NE(issue.text.find(member), std::string::npos) << issue.text;
  }
  EXPECT_EQ(refusal("baseColorFactor", {0.5, 0.5, 0.5}).id, issue_id::kGltfParse);  // without its alpha
  EXPECT_NE(refusal("metallicFactor", -3).text.find("-3"), std::string::npos);
  for (const auto& [member, value] : {std::pair<const char*, Json>("metallicFactor", 1),
                                      {"roughnessFactor", 0},
                                      {"baseColorFactor", {1, 0, 1, 1}}})
    EXPECT_EQ(refusal(member, value).id, 0) << member;
}

TEST(TileMaterialRanges, AreCheckedInObjFilesToo) {
  const TemporaryFolder folder;
  const std::string path = folder.write(
      "t.obj", "mtllib m.mtl\nusemtl cloth\n" +
                   objGrid(
                       2, [](glm::dvec2 q) { return glm::dvec3(q, 0); }, [](glm::dvec2 q) { return q; }));
  const auto loaded = [&](const std::string& line) {
    folder.write("m.mtl", "newmtl cloth\n" + line + "\n");
    return loadTile(path);
  };
  for (const char* line :
       {"Kd -1 0 0", "Kd 2 2 2", "Kd nan 0 0", "Ks 0 0 1.5", "Ks -1 0 0", "Ns -1", "Ns inf", "Ns nan"}) {
    const auto tile = loaded(line);
    ASSERT_FALSE(tile.ok()) << line;
    EXPECT_EQ(tile.issue().id, issue_id::kTileMaterial) << line;
    EXPECT_NE(tile.issue().where.find("m.mtl: line 2, material 'cloth'"), std::string::npos)
        << tile.issue().where;
  }
  EXPECT_NE(loaded("Kd -1 0 0").issue().text.find("-1"), std::string::npos);
  for (const char* line : {"Kd 1 1 1", "Kd 0 0 0", "Ks 1 1 1", "Ns 0", "Ns 1000"})
    EXPECT_TRUE(loaded(line).ok()) << line;
  EXPECT_EQ(loaded("map_Kd weave.png")->warnings.size(), 1u);
}

TEST(TileTexture, PictureWithTooManyPixelsIsRefusedByItsHeader) {
  Json json = checkerTile();
  json["images"][0]["uri"] = std::string("data:image/png;base64,") + kHuge;
  const auto tile = load(json);
  ASSERT_FALSE(tile.ok());
  EXPECT_EQ(tile.issue().id, issue_id::kTileMaterial);
  EXPECT_NE(tile.issue().text.find("16384 x 16384"), std::string::npos) << tile.issue().text;
}

}  // namespace
}  // namespace loden::importer
