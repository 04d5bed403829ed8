// Catmull-Clark limits against known answers and finite differences.
#include <gtest/gtest.h>

#include <array>
#include <map>
#include <vector>

#include "material/base/issues.h"
#include "runtime/scene/limit_surface.h"

namespace loden::runtime {
namespace {

void addQuad(Mesh& mesh, std::array<uint32_t, 4> q) {
  mesh.indices.insert(mesh.indices.end(), {q[0], q[1], q[2], q[0], q[2], q[3]});
}

// n x n quads over [0, 1]^2 at z = height(x, y), uv = (3x, 2y).
template <class Height>
Mesh gridCage(int n, const Height& height) {
  Mesh mesh;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const float x = static_cast<float>(i) / static_cast<float>(n),
                  y = static_cast<float>(j) / static_cast<float>(n);
      Vertex vertex;
      vertex.position = {x, y, height(x, y)};
      vertex.uv = {3 * x, 2 * y};
      mesh.vertices.push_back(vertex);
    }
  for (uint32_t j = 0; j < uint32_t(n); ++j)
    for (uint32_t i = 0; i < uint32_t(n); ++i) {
      const uint32_t a = j * (n + 1) + i;
      addQuad(mesh, {a, a + 1, a + n + 2, a + n + 1});
    }
  return mesh;
}

// The cube [-1, 1]^3, each face with its own vertices and UVs.
Mesh cubeCage() {
  Mesh mesh;
  for (int axis = 0; axis < 3; ++axis)
    for (float side : {-1.0f, 1.0f}) {
      const auto first = static_cast<uint32_t>(mesh.vertices.size());
      for (glm::vec2 c : {glm::vec2(-1, -1), glm::vec2(1, -1), glm::vec2(1, 1), glm::vec2(-1, 1)}) {
        Vertex vertex;
        vertex.position[axis] = side;
        vertex.position[(axis + 1) % 3] = c.x * side;
        vertex.position[(axis + 2) % 3] = c.y;
        vertex.uv = c;
        mesh.vertices.push_back(vertex);
      }
      addQuad(mesh, {first, first + 1, first + 2, first + 3});
    }
  return mesh;
}

TEST(LimitSurface, FlatCageStaysFlatAndUvsStayLinear) {
  const auto mesh = limitSurface(gridCage(4, [](float, float) { return 0.0f; }), 3, "test");
  ASSERT_TRUE(mesh.ok());
  EXPECT_EQ(mesh->vertices.size(), 16u * 81u);
  for (const Vertex& vertex : mesh->vertices) {
    EXPECT_NEAR(vertex.position.z, 0, 1e-6);
    EXPECT_NEAR(vertex.normal.z, 1, 1e-6);
    // Catmull-Clark reproduces linear functions, borders included.
    EXPECT_NEAR(vertex.uv.x, 3 * vertex.position.x, 1e-5);
    EXPECT_NEAR(vertex.uv.y, 2 * vertex.position.y, 1e-5);
    EXPECT_NEAR(glm::distance(vertex.tangent, glm::vec4(1, 0, 0, 1)), 0, 1e-5);
  }
}

// Halstead et al. 1993: the limit of a vertex v of valence n with edge neighbours e and face neighbours f of
// a quad mesh is (n^2 v + 4 sum e + sum f) / (n (n + 5)); on the cube's corner (1, 1, 1) it is 5/12 of it.
TEST(LimitSurface, CubeCornerIsWhereTheMasksPutIt) {
  const auto mesh = limitSurface(cubeCage(), 2, "test");
  ASSERT_TRUE(mesh.ok());
  const double expected = (9 * 1 + 4 * (1 + 1 - 1) + (1 - 1 - 1)) / 24.0;
  double closest = 1;
  for (const Vertex& vertex : mesh->vertices)
    closest = std::min(closest, double(glm::distance(vertex.position, glm::vec3(float(expected)))));
  EXPECT_LT(closest, 1e-5);
}

TEST(LimitSurface, HasNoCracksAlthoughUvsAreSplit) {
  const auto mesh = limitSurface(cubeCage(), 3, "test");
  ASSERT_TRUE(mesh.ok());
  // Every border point of a face grid lies on at least two grids, at bit-equal positions with equal normals.
  std::map<std::array<float, 3>, std::pair<int, glm::vec3>> seen;
  for (const Vertex& vertex : mesh->vertices) {
    const std::array key{vertex.position.x, vertex.position.y, vertex.position.z};
    auto [it, fresh] = seen.try_emplace(key, 0, vertex.normal);
    ++it->second.first;
    EXPECT_EQ(it->second.second, vertex.normal);
  }
  EXPECT_EQ(seen.size(), 6u * 64u + 2u);  // a closed quad mesh: vertices = faces + 2
}

TEST(LimitSurface, TangentsAreDerivativesOfTheSurface) {
  const auto mesh =
      limitSurface(gridCage(5, [](float x, float y) { return 0.3f * x * x - 0.4f * x * y; }), 5, "test");
  ASSERT_TRUE(mesh.ok());
  constexpr int kRow = 33;
  // Inner points of the middle quad; central differences along s, which is along u.
  const Vertex* grid = &mesh->vertices[12 * kRow * kRow];
  for (int j = 1; j < kRow - 1; ++j)
    for (int i = 1; i < kRow - 1; ++i) {
      const Vertex& vertex = grid[j * kRow + i];
      const glm::vec3 along =
          glm::normalize(grid[j * kRow + i + 1].position - grid[j * kRow + i - 1].position);
      EXPECT_NEAR(glm::dot(glm::vec3(vertex.tangent), along), 1, 1e-4);
      EXPECT_NEAR(glm::dot(vertex.normal, along), 0, 1e-3);
      EXPECT_NEAR(glm::dot(vertex.normal, glm::vec3(vertex.tangent)), 0, 1e-5);
    }
}

TEST(LimitSurface, RejectsWhatIsNoQuadCage) {
  Mesh odd = gridCage(1, [](float, float) { return 0.0f; });
  odd.indices.resize(3);
  EXPECT_EQ(limitSurface(odd, 1, "test").issue().id, issue_id::kGltfExtension);

  Mesh crossed = gridCage(1, [](float, float) { return 0.0f; });
  std::swap(crossed.indices[3], crossed.indices[4]);
  EXPECT_EQ(limitSurface(crossed, 1, "test").issue().id, issue_id::kGltfExtension);

  Mesh collapsed = gridCage(1, [](float, float) { return 0.0f; });
  collapsed.vertices[1].position = collapsed.vertices[0].position;
  EXPECT_EQ(limitSurface(collapsed, 1, "test").issue().id, issue_id::kGltfExtension);

  Mesh fan = gridCage(1, [](float, float) { return 0.0f; });
  fan.indices.insert(fan.indices.end(), fan.indices.begin(), fan.indices.begin() + 6);
  EXPECT_EQ(limitSurface(fan, 1, "test").issue().id, issue_id::kGltfExtension);
}

}  // namespace
}  // namespace loden::runtime
