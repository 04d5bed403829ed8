// Meshes under EXT_meshopt_compression, whole and damaged.
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <array>

#include "material/base/issues.h"
#include "tests/unit/gltf_builder.h"

namespace loden::test {
namespace {

using namespace runtime;

constexpr int kSide = 9;  // vertices along a side of the grid

struct Grid {
  std::vector<float> positions;  // 4 floats each: a stride of 16
  std::vector<uint32_t> indices;
};
Grid makeGrid() {
  Grid grid;
  for (int i = 0; i < kSide * kSide; ++i)
    grid.positions.insert(grid.positions.end(), {float(i % kSide), float(i / kSide), float(i % 3), 0});
  for (uint32_t j = 0; j + 1 < kSide; ++j)
    for (uint32_t i = 0; i + 1 < kSide; ++i) {
      const uint32_t a = j * kSide + i, d = a + kSide;
      grid.indices.insert(grid.indices.end(), {a, a + 1, d + 1, a, d + 1, d});
    }
  return grid;
}

// The triangles as their corners' positions, each from its smallest corner on, sorted: equal whatever the
// order.
std::vector<std::array<float, 9>> triangles(const Mesh& mesh) {
  std::vector<std::array<float, 9>> all;
  for (size_t i = 0; i < mesh.indices.size(); i += 3) {
    std::array<std::array<float, 3>, 3> corners;
    for (size_t k = 0; k < 3; ++k) {
      const glm::vec3& p = mesh.vertices[mesh.indices[i + k]].position;
      corners[k] = {p.x, p.y, p.z};
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    all.emplace_back();
    for (size_t k = 0; k < 9; ++k) all.back()[k] = corners[k / 3][k % 3];
  }
  std::sort(all.begin(), all.end());
  return all;
}

std::vector<std::array<float, 9>> expectedTriangles() {
  const Grid grid = makeGrid();
  Mesh mesh;
  for (size_t i = 0; i < grid.positions.size(); i += 4) {
    Vertex vertex;
    vertex.position = {grid.positions[i], grid.positions[i + 1], grid.positions[i + 2]};
    mesh.vertices.push_back(vertex);
  }
  mesh.indices = grid.indices;
  return triangles(mesh);
}

std::string packedPositions() {
  const Grid grid = makeGrid();
  std::string bytes(meshopt_encodeVertexBufferBound(kSide * kSide, 16), '\0');
  bytes.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(bytes.data()), bytes.size(),
                                          grid.positions.data(), kSide * kSide, 16));
  return bytes;
}
std::string packedIndices() {
  const Grid grid = makeGrid();
  std::string bytes(meshopt_encodeIndexBufferBound(grid.indices.size(), kSide * kSide), '\0');
  bytes.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(bytes.data()), bytes.size(),
                                         grid.indices.data(), grid.indices.size()));
  return bytes;
}

// Views into a buffer without bytes that the extension fills from the first.
void addMeshopt(GltfBuilder& builder, const std::string& positions, const std::string& indices) {
  const size_t index_count = makeGrid().indices.size();
  const auto compressed = [&](const std::string& bytes, size_t count, size_t stride, const char* mode) {
    const int view = builder.view(bytes);
    Json& place = builder.json["bufferViews"][size_t(view)];
    Json extension{{"buffer", 0},
                   {"byteOffset", place["byteOffset"]},
                   {"byteLength", bytes.size()},
                   {"count", count},
                   {"byteStride", stride},
                   {"mode", mode}};
    place = {{"buffer", 1}, {"byteLength", count * stride}};
    if (stride == 16) place["byteStride"] = stride;
    place["extensions"]["EXT_meshopt_compression"] = extension;
    return view;
  };
  const int position_view = compressed(positions, kSide * kSide, 16, "ATTRIBUTES");
  const int index_view = compressed(indices, index_count, 4, "TRIANGLES");
  const int position = builder.accessor(position_view, 5126, kSide * kSide, "VEC3");
  builder.node(
      {{"mesh", builder.mesh({{"attributes", {{"POSITION", position}}},
                              {"indices", builder.accessor(index_view, 5125, index_count, "SCALAR")}})}});
  builder.json["extensionsUsed"] = builder.json["extensionsRequired"] = {"EXT_meshopt_compression"};
  builder.more_buffers = {
      {{"byteLength", 4096}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}};
}

TEST(CompressedMeshes, MeshoptGivesTheMesh) {
  GltfBuilder builder;
  addMeshopt(builder, packedPositions(), packedIndices());
  const Result<Scene> scene = builder.load();
  ASSERT_TRUE(scene.ok()) << scene.issue().where << ": " << scene.issue().text;
  EXPECT_EQ(triangles(scene->meshes[0]), expectedTriangles());
}

// No crash, and indices that name vertices.
void expectIssueOrMesh(GltfBuilder& builder) {
  const Result<Scene> scene = builder.load();
  if (!scene.ok()) return;
  for (const uint32_t index : scene->meshes[0].indices) ASSERT_LT(index, scene->meshes[0].vertices.size());
}

TEST(CompressedMeshes, DamagedMeshoptIsAnIssueOrAMesh) {
  GltfBuilder builder;
  addMeshopt(builder, packedPositions(), packedIndices());
  const std::string whole = builder.bytes;
  for (size_t at = 0; at < whole.size(); at += 5) {
    builder.bytes = whole;
    builder.bytes[at] ^= '\x55';
    expectIssueOrMesh(builder);
  }
}

TEST(CompressedMeshes, MeshoptParametersAreChecked) {
  const std::pair<const char*, Json> cases[] = {
      {"byteStride", 3},   {"byteStride", 0},         {"byteStride", 1024}, {"count", 0},
      {"mode", "THINGS"},  {"filter", "SHARPEN"},     {"buffer", 7},        {"byteLength", 100000},
      {"count", 90000000}, {"byteOffset", 100000000}, {"byteLength", 0}};
  for (const auto& [key, value] : cases) {
    GltfBuilder builder;
    addMeshopt(builder, packedPositions(), packedIndices());
    builder.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"][key] = value;
    const Result<Scene> scene = builder.load();
    ASSERT_FALSE(scene.ok()) << key << " " << value;
    EXPECT_EQ(scene.issue().id, issue_id::kGltfExtension);
    EXPECT_NE(scene.issue().where.find("bufferViews[0]"), std::string::npos) << scene.issue().where;
  }
}

}  // namespace
}  // namespace loden::test
