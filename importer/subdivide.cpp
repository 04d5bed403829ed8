#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefinerFactory.h>

#include <algorithm>
#include <memory>

#include "importer/tile_internal.h"
#include "importer/weld.h"
#include "material/issues.h"

namespace loden::importer {
namespace {

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

constexpr double kTolerance = 1e-5;  // of equal positions and texture coordinates, tile periods

// What is refined: everything a vertex carries.
struct Primvar {
  glm::dvec3 position{0};
  glm::dvec2 uv{0};
  glm::dvec3 diffuse{0};
  glm::dvec2 specular{0};
  glm::dvec4 ggx{0};  // f0, alpha
  void Clear() { *this = {}; }
  void AddWithWeight(const Primvar& other, float weight) {
    position += double(weight) * other.position, uv += double(weight) * other.uv;
    diffuse += double(weight) * other.diffuse, specular += double(weight) * other.specular;
    ggx += double(weight) * other.ggx;
  }
};

// The cage with its eight neighbours, joined where they meet, so that the middle copy has no border.
struct PeriodicCage {
  std::vector<Primvar> vertices;
  std::vector<int> face_sizes, corners;  // the middle copy's faces first
  size_t middle_faces = 0;
};

Result<PeriodicCage> repeatCage(const PolygonMesh& mesh, const glm::dvec2& period, const std::string& where) {
  std::vector<glm::dvec3> positions;
  std::vector<Primvar> all;
  std::vector<glm::ivec2> copies{{0, 0}};
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i)
      if (i != 0 || j != 0) copies.push_back({i, j});
  for (const glm::ivec2& copy : copies)
    for (size_t v = 0; v < mesh.positions.size(); ++v) {
      positions.push_back(mesh.positions[v] + glm::dvec3(glm::dvec2(copy) * period, 0));
      const LocalBrdf& brdf = mesh.brdfs[v];
      all.push_back({positions.back(), mesh.uvs[v] + glm::dvec2(copy), glm::dvec3(brdf.diffuse), {brdf.specular, brdf.exponent}, glm::dvec4(brdf.f0, brdf.alpha)});
    }
  const auto joined = weldVertices(positions, glm::dvec3(0), kTolerance * period.x);
  PeriodicCage cage;
  std::vector<int> index(positions.size(), -1);
  for (size_t v = 0; v < positions.size(); ++v) {
    const uint32_t same = joined[v];
    if (glm::any(glm::greaterThan(glm::abs(all[v].uv - all[same].uv), glm::dvec2(kTolerance))))
      return Issue{issue_id::kTileUv, Severity::kError, where + ": vertex " + std::to_string(v % mesh.positions.size()),
                   "a cage needs one unbroken parameterization: texture coordinates jump here"};
    if (same == v) index[v] = int(cage.vertices.size()), cage.vertices.push_back(all[v]);
  }
  for (size_t copy = 0; copy < copies.size(); ++copy)
    for (const uint32_t corner : mesh.corners) cage.corners.push_back(index[joined[copy * mesh.positions.size() + corner]]);
  for (size_t copy = 0; copy < copies.size(); ++copy)
    cage.face_sizes.insert(cage.face_sizes.end(), mesh.face_sizes.begin(), mesh.face_sizes.end());
  cage.middle_faces = mesh.face_sizes.size();
  return cage;
}

std::unique_ptr<Far::TopologyRefiner> makeRefiner(const PeriodicCage& cage, int levels) {
  const bool triangles = std::all_of(cage.face_sizes.begin(), cage.face_sizes.end(), [](int size) { return size == 3; });
  const Sdc::SchemeType scheme = triangles ? Sdc::SCHEME_LOOP : Sdc::SCHEME_CATMARK;
  Sdc::Options options;
  options.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_ONLY);
  Far::TopologyDescriptor descriptor;
  descriptor.numVertices = int(cage.vertices.size());
  descriptor.numFaces = int(cage.face_sizes.size());
  descriptor.numVertsPerFace = cage.face_sizes.data();
  descriptor.vertIndicesPerFace = cage.corners.data();
  using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
  std::unique_ptr<Far::TopologyRefiner> refiner(Factory::Create(descriptor, Factory::Options(scheme, options)));
  Far::TopologyRefiner::UniformOptions uniform(levels);
  uniform.fullTopologyInLastLevel = true;  // limit positions need it
  if (refiner) refiner->RefineUniform(uniform);
  return refiner;
}

// Whether a face of the last level descends from the middle copy.
bool fromMiddle(const Far::TopologyRefiner& refiner, int levels, int face, size_t middle_faces) {
  for (int level = levels; level > 0; --level) face = refiner.GetLevel(level).GetFaceParentFace(face);
  return size_t(face) < middle_faces;
}

}  // namespace

Result<PolygonMesh> subdivideMesh(const PolygonMesh& mesh, const glm::dvec2& period, int levels, const std::string& where) {
  LODEN_CHECK_LT(0, levels);
  const auto cage = repeatCage(mesh, period, where);
  if (!cage) return cage.issue();
  const auto refiner = makeRefiner(*cage, levels);
  if (!refiner) return Issue{issue_id::kTileGeometry, Severity::kError, where, "OpenSubdiv refuses the cage: its faces do not form a surface"};

  const Far::PrimvarRefiner primvars(*refiner);
  std::vector<Primvar> level_values = cage->vertices;
  for (int level = 1; level <= levels; ++level) {
    std::vector<Primvar> finer(size_t(refiner->GetLevel(level).GetNumVertices()));
    primvars.Interpolate(level, level_values, finer);
    level_values = std::move(finer);
  }
  std::vector<Primvar> limit(level_values.size()), tangent(level_values.size()), bitangent(level_values.size());
  primvars.Limit(level_values, limit, tangent, bitangent);

  PolygonMesh result;
  constexpr uint32_t kUnused = 0xFFFFFFFFu;
  std::vector<uint32_t> index(limit.size(), kUnused);
  const Far::TopologyLevel& last = refiner->GetLevel(levels);
  for (int face = 0; face < last.GetNumFaces(); ++face) {
    if (!fromMiddle(*refiner, levels, face, cage->middle_faces)) continue;
    const Far::ConstIndexArray corners = last.GetFaceVertices(face);
    result.face_sizes.push_back(corners.size());
    for (int k = 0; k < corners.size(); ++k) {
      const auto v = size_t(corners[k]);
      if (index[v] == kUnused) {
        index[v] = uint32_t(result.positions.size());
        result.positions.push_back(limit[v].position);
        result.normals.push_back(glm::normalize(glm::cross(tangent[v].position, bitangent[v].position)));
        result.uvs.push_back(limit[v].uv);
        result.brdfs.push_back({glm::vec3(limit[v].diffuse), float(limit[v].specular.x), float(limit[v].specular.y), glm::vec3(limit[v].ggx),
                                float(limit[v].ggx.w)});
      }
      result.corners.push_back(index[v]);
    }
  }
  return result;
}

}  // namespace loden::importer
