// What exporters leave in meshes: repaired, or refused by name.
#include <gtest/gtest.h>

#include <algorithm>

#include "importer/mesh/parameterize.h"
#include "importer/mesh/periodic_mesh.h"
#include "importer/tile/file/mesh_repair.h"
#include "importer_meshes.h"
#include "material/base/issues.h"

namespace loden::importer {
namespace {

using testing::objGrid;
using testing::TemporaryFolder;

constexpr int kCells = 8;
const auto kWave = [](glm::dvec2 q) {
  return glm::dvec3(q, 0.1 * std::sin(2 * kPi * q.x) * std::cos(2 * kPi * q.y));
};
const auto kSame = [](glm::dvec2 q) { return q; };

int vertexOf(int i, int j) {
  return j * (kCells + 1) + i + 1;
}  // 1-based, of the grid

// The grid without its cell (3, 4), and other faces in its place.
std::string gridWith(const std::string& faces) {
  std::string text = objGrid(kCells, kWave, nullptr);
  std::ostringstream cell;
  cell << "f " << vertexOf(3, 4) << ' ' << vertexOf(4, 4) << ' ' << vertexOf(4, 5) << ' ' << vertexOf(3, 5)
       << '\n';
  const size_t at = text.find(cell.str());
  EXPECT_NE(at, std::string::npos);
  text.replace(at, cell.str().size(), faces);
  return text;
}

std::string face(std::initializer_list<int> corners) {
  std::string text = "f";
  for (const int c : corners) text += ' ' + std::to_string(c);
  return text + '\n';
}

std::string vertex(const glm::dvec3& p) {
  std::ostringstream text;
  text.precision(17);
  text << "v " << p.x << ' ' << p.y << ' ' << p.z << '\n';
  return text.str();
}

constexpr int kNext = (kCells + 1) * (kCells + 1) + 1;  // the first added vertex
const int kA = vertexOf(3, 4), kB = vertexOf(4, 4), kC = vertexOf(4, 5), kD = vertexOf(3, 5);
const glm::dvec3 kBottom = (kWave({3.0 / 8, 4.0 / 8}) + kWave({4.0 / 8, 4.0 / 8})) / 2.0;  // middle of AB

// It loads, is closed, has a sound parameterization and nothing that is not finite.
Tile expectSound(const std::string& obj) {
  const TemporaryFolder folder;
  const auto tile = loadTile(folder.write("t.obj", obj).string());
  EXPECT_TRUE(tile.ok()) << tile.issue().where << ": " << tile.issue().text;
  if (!tile) return {};
  for (size_t v = 0; v < tile->positions.size(); ++v) {
    EXPECT_TRUE(std::isfinite(tile->positions[v].x + tile->positions[v].y + tile->positions[v].z));
    EXPECT_TRUE(std::isfinite(tile->params[v].x + tile->params[v].y));
    EXPECT_NEAR(glm::length(tile->normals[v]), 1, 1e-9);
  }
  const auto neighbours =
      findNeighbours(tile->positions, tile->triangles, periodicNodes(tile->positions), "test");
  EXPECT_TRUE(neighbours.ok());
  if (!neighbours) return {};
  EXPECT_TRUE(
      std::all_of(neighbours->begin(), neighbours->end(), [](const Neighbour& n) { return n.exists(); }));
  EXPECT_EQ(measureParameterization(tile->positions, tile->params, tile->triangles).flipped, 0);
  return *tile;
}

Issue refusal(const std::string& obj) {
  const TemporaryFolder folder;
  const auto tile = loadTile(folder.write("t.obj", obj).string());
  EXPECT_FALSE(tile.ok());
  return tile.ok() ? Issue{} : tile.issue();
}

TEST(MeshRepair, LeavesASoundMeshAlone) {
  EXPECT_EQ(expectSound(objGrid(kCells, kWave, nullptr)).triangles.size(), size_t(2 * kCells * kCells));
  EXPECT_EQ(expectSound(objGrid(kCells, kWave, kSame)).triangles.size(), size_t(2 * kCells * kCells));
}

TEST(MeshRepair, DropsTrianglesWithoutAreaAndRepeatedOnes) {
  const std::string cell = face({kA, kB, kC, kD});
  EXPECT_EQ(expectSound(gridWith(cell + face({kA, kA, kB}) + face({kA, kB, kB}) + face({kA, kB, kC})))
                .triangles.size(),
            128u);
  // Corners on a line: the middle one splits the neighbour across the long side.
  const std::string cap = vertex(kBottom) + face({kA, kNext, kD}) + face({kNext, kB, kC}) +
                          face({kNext, kC, kD}) + face({kA, kB, kNext});
  EXPECT_EQ(expectSound(gridWith(cap)).triangles.size(), 130u);
}

TEST(MeshRepair, ClosesTJunctions) {
  // Two vertices on the edge that the cell shares with the one below, which has neither.
  const glm::dvec3 a = kWave({3.0 / 8, 4.0 / 8}), b = kWave({4.0 / 8, 4.0 / 8});
  const std::string cell = vertex(glm::mix(a, b, 0.25)) + vertex(glm::mix(a, b, 0.6)) +
                           face({kA, kNext, kD}) + face({kNext, kNext + 1, kD}) + face({kNext + 1, kB, kC}) +
                           face({kNext + 1, kC, kD});
  const Tile tile = expectSound(gridWith(cell));
  EXPECT_EQ(tile.triangles.size(), 126u + 4 + 2);  // the cell's four, and two more below
}

TEST(MeshRepair, ClosesTJunctionsUnderTextureCoordinates) {
  const TemporaryFolder folder;
  std::string text = objGrid(kCells, kWave, kSame);
  const auto corner = [](int v) { return std::to_string(v) + "/" + std::to_string(v); };
  const std::string cell = "f " + corner(kA) + ' ' + corner(kB) + ' ' + corner(kC) + ' ' + corner(kD) + '\n',
                    middle = corner(kNext);
  const size_t at = text.find(cell);
  ASSERT_NE(at, std::string::npos);
  text.replace(at, cell.size(),
               vertex(kBottom) + "vt 0.4375 0.5\nf " + corner(kA) + ' ' + middle + ' ' + corner(kD) + "\nf " +
                   middle + ' ' + corner(kB) + ' ' + corner(kC) + "\nf " + middle + ' ' + corner(kC) + ' ' +
                   corner(kD) + '\n');
  const Tile tile = expectSound(text);
  EXPECT_EQ(tile.triangles.size(), 126u + 3 + 1);
  for (size_t v = 0; v < tile.params.size(); ++v)
    EXPECT_LT(glm::distance(tile.params[v], glm::dvec2(tile.positions[v])), 1e-9);
}

TEST(MeshRepair, TakesNeedlesAway) {
  // One with a corner next to its long side, one with two corners in nearly the same place.
  const std::string flat = vertex(kBottom + glm::dvec3(0, 1e-8, 0)) + face({kA, kNext, kD}) +
                           face({kNext, kB, kC}) + face({kNext, kC, kD}) + face({kA, kB, kNext});
  EXPECT_EQ(expectSound(gridWith(flat)).triangles.size(), 130u);
  const glm::dvec3 near_a = kWave({3.0 / 8, 4.0 / 8}) + glm::dvec3(1e-7, 1e-7, 0);
  const std::string sharp = vertex(near_a) + face({kA, kB, kNext}) + face({kNext, kB, kC}) +
                            face({kNext, kC, kD}) + face({kNext, kD, kA});
  EXPECT_EQ(expectSound(gridWith(sharp)).triangles.size(), 128u);
}

TEST(MeshRepair, RefusesEdgesOfThreeTrianglesByName) {
  const std::string fin =
      face({kA, kB, kC, kD}) + vertex(kBottom + glm::dvec3(0, 0, 0.2)) + face({kA, kB, kNext});
  const Issue issue = refusal(gridWith(fin));
  EXPECT_EQ(issue.id, issue_id::kTileGeometry);
  EXPECT_NE(issue.where.find("triangle "), std::string::npos) << issue.where;
  EXPECT_NE(issue.where.find("at (0."), std::string::npos) << issue.where;
  EXPECT_NE(issue.text.find("more than two"), std::string::npos) << issue.text;
}

TEST(MeshRepair, LaterRefusalsCountTrianglesAsTheFileDoes) {
  const auto numberOf = [](const std::string& before) {  // a grid of period 4 far from the origin, without
                                                         // texture coordinates and with a hole
    const TemporaryFolder folder;
    std::string text = objGrid(
        8, [](glm::dvec2 q) { return 4.0 * glm::dvec3(q.x + 5, q.y - 7, .05 * std::sin(2 * kPi * q.x)); },
        nullptr);
    text.insert(text.find("f "), before);
    text.erase(text.rfind("f 40 "), text.find('\n', text.rfind("f 40 ")) - text.rfind("f 40 ") + 1);
    const auto tile = loadTile(folder.write("t.obj", text).string());
    EXPECT_FALSE(tile.ok());
    EXPECT_NE(tile.issue().where.find("at (2"), std::string::npos)
        << tile.issue().where;  // x in the file's units
    const size_t at = tile.issue().where.find("triangle ");
    return at == std::string::npos ? -1 : std::stoi(tile.issue().where.substr(at + 9));
  };
  const int plain = numberOf("");
  EXPECT_GE(plain, 0);
  EXPECT_EQ(numberOf("f 1 2 2\nf 1 2 2\nf 1 2 2\n"), plain + 3);
}

TEST(MeshRepair, RefusesNeighboursThatFaceOppositeWaysByName) {
  const Issue issue = refusal(gridWith(face({kA, kD, kC, kB})));
  EXPECT_EQ(issue.id, issue_id::kTileGeometry);
  EXPECT_NE(issue.where.find("triangle "), std::string::npos) << issue.where;
  EXPECT_NE(issue.text.find("opposite way"), std::string::npos) << issue.text;
}

TEST(MeshRepair, RefusesAMeshOfDegenerateTrianglesOnly) {
  const Issue issue = refusal("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  EXPECT_EQ(issue.id, issue_id::kTileGeometry);
  EXPECT_NE(issue.text.find("degenerate"), std::string::npos) << issue.text;
}

}  // namespace
}  // namespace loden::importer
