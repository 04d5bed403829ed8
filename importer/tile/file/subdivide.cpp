#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefinerFactory.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>

#include "importer/mesh/weld.h"
#include "importer/tile/polygon_mesh.h"
#include "material/base/issues.h"

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

// Texture coordinates of both pictures; they may jump where the surface does not, so corners have them, not
// vertices.
struct Coordinates {
  glm::dvec4 uvs{0};
  void Clear() { *this = {}; }
  void AddWithWeight(const Coordinates& other, float weight) { uvs += double(weight) * other.uvs; }
};

// The cage with its eight neighbours, joined where they meet, so that the middle copy has no border.
struct PeriodicCage {
  std::vector<Primvar> vertices;
  std::vector<int> face_sizes, corners;  // the middle copy's faces first
  size_t middle_faces = 0;
  // If something is textured: values that differ, and which of them each corner has. Corners at one vertex
  // and of one material share a value if their coordinates are equal; elsewhere is a seam, as along the
  // period's border.
  std::vector<Coordinates> coordinates;
  std::vector<int> coordinates_of_corner;
  std::vector<uint32_t> material_of_face;  // of the middle copy

  bool textured() const { return !coordinates.empty(); }
};

void addTextures(const PolygonMesh& mesh, const std::vector<uint32_t>& joined, size_t copies,
                 PeriodicCage& cage) {
  std::map<std::array<double, 6>, int> values;
  std::vector<int> value_of(mesh.positions.size());
  for (size_t v = 0; v < mesh.positions.size(); ++v) {
    const TexturePoint& at = mesh.texture_points[v];
    const glm::dvec4 uvs(at.base_color, at.metallic_roughness);
    const auto [entry, added] = values.try_emplace(
        {double(joined[v]), double(at.material), uvs.x, uvs.y, uvs.z, uvs.w}, int(values.size()));
    if (added) cage.coordinates.push_back({uvs});
    value_of[v] = entry->second;
  }
  const size_t in_copy = cage.coordinates.size();
  for (size_t copy = 0; copy < copies; ++copy) {
    if (copy > 0)
      for (size_t k = 0; k < in_copy; ++k) cage.coordinates.push_back(Coordinates(cage.coordinates[k]));
    for (const uint32_t corner : mesh.corners)
      cage.coordinates_of_corner.push_back(value_of[corner] + int(copy * in_copy));
  }
  size_t first = 0;
  for (const int size : mesh.face_sizes) {
    cage.material_of_face.push_back(mesh.texture_points[mesh.corners[first]].material);
    first += size_t(size);
  }
}

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
      all.push_back({positions.back(),
                     mesh.uvs[v] + glm::dvec2(copy),
                     glm::dvec3(brdf.diffuse),
                     {brdf.specular, brdf.exponent},
                     glm::dvec4(brdf.f0, brdf.alpha)});
    }
  const auto joined = weldVertices(positions, glm::dvec3(0), kTolerance * period.x);
  PeriodicCage cage;
  std::vector<int> index(positions.size(), -1);
  for (size_t v = 0; v < positions.size(); ++v) {
    const uint32_t same = joined[v];
    if (glm::any(glm::greaterThan(glm::abs(all[v].uv - all[same].uv), glm::dvec2(kTolerance))))
      return Issue{issue_id::kTileUv, Severity::kError,
                   where + ": vertex " + std::to_string(v % mesh.positions.size()),
                   "a cage needs one unbroken parameterization: texture coordinates jump here"};
    if (same == v) index[v] = int(cage.vertices.size()), cage.vertices.push_back(all[v]);
  }
  for (size_t copy = 0; copy < copies.size(); ++copy)
    for (const uint32_t corner : mesh.corners)
      cage.corners.push_back(index[joined[copy * mesh.positions.size() + corner]]);
  for (size_t copy = 0; copy < copies.size(); ++copy)
    cage.face_sizes.insert(cage.face_sizes.end(), mesh.face_sizes.begin(), mesh.face_sizes.end());
  cage.middle_faces = mesh.face_sizes.size();
  if (!mesh.texture_points.empty()) addTextures(mesh, joined, copies.size(), cage);
  return cage;
}

std::unique_ptr<Far::TopologyRefiner> makeRefiner(const PeriodicCage& cage, int levels) {
  const bool triangles =
      std::all_of(cage.face_sizes.begin(), cage.face_sizes.end(), [](int size) { return size == 3; });
  const Sdc::SchemeType scheme = triangles ? Sdc::SCHEME_LOOP : Sdc::SCHEME_CATMARK;
  Sdc::Options options;
  options.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_ONLY);
  options.SetFVarLinearInterpolation(Sdc::Options::FVAR_LINEAR_CORNERS_ONLY);  // as the runtime's
  Far::TopologyDescriptor descriptor;
  descriptor.numVertices = int(cage.vertices.size());
  descriptor.numFaces = int(cage.face_sizes.size());
  descriptor.numVertsPerFace = cage.face_sizes.data();
  descriptor.vertIndicesPerFace = cage.corners.data();
  Far::TopologyDescriptor::FVarChannel channel;
  channel.numValues = int(cage.coordinates.size());
  channel.valueIndices = cage.coordinates_of_corner.data();
  if (cage.textured()) descriptor.numFVarChannels = 1, descriptor.fvarChannels = &channel;
  using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
  std::unique_ptr<Far::TopologyRefiner> refiner(
      Factory::Create(descriptor, Factory::Options(scheme, options)));
  Far::TopologyRefiner::UniformOptions uniform(levels);
  uniform.fullTopologyInLastLevel = true;  // limit positions need it
  if (refiner) refiner->RefineUniform(uniform);
  return refiner;
}

// The face of the cage that a face of the last level descends from.
size_t cageFace(const Far::TopologyRefiner& refiner, int levels, int face) {
  for (int level = levels; level > 0; --level) face = refiner.GetLevel(level).GetFaceParentFace(face);
  return size_t(face);
}

// At the limit, per value of the last level.
std::vector<Coordinates> limitCoordinates(const Far::TopologyRefiner& refiner, int levels,
                                          std::vector<Coordinates> values) {
  const Far::PrimvarRefiner primvars(refiner);
  for (int level = 1; level <= levels; ++level) {
    std::vector<Coordinates> finer(size_t(refiner.GetLevel(level).GetNumFVarValues()));
    primvars.InterpolateFaceVarying(level, values, finer);
    values = std::move(finer);
  }
  std::vector<Coordinates> limit(values.size());
  primvars.LimitFaceVarying(values, limit);
  return limit;
}

}  // namespace

Result<PolygonMesh> subdivideMesh(const PolygonMesh& mesh, const glm::dvec2& period, int levels,
                                  const std::string& where) {
  LODEN_CHECK_LT(0, levels);
  const auto cage = repeatCage(mesh, period, where);
  if (!cage) return cage.issue();
  const auto refiner = makeRefiner(*cage, levels);
  if (!refiner)
    return Issue{issue_id::kTileGeometry, Severity::kError, where,
                 "OpenSubdiv refuses the cage: its faces do not form a surface"};

  const Far::PrimvarRefiner primvars(*refiner);
  std::vector<Primvar> level_values = cage->vertices;
  for (int level = 1; level <= levels; ++level) {
    std::vector<Primvar> finer(size_t(refiner->GetLevel(level).GetNumVertices()));
    primvars.Interpolate(level, level_values, finer);
    level_values = std::move(finer);
  }
  std::vector<Primvar> limit(level_values.size()), tangent(level_values.size()),
      bitangent(level_values.size());
  primvars.Limit(level_values, limit, tangent, bitangent);

  std::vector<Coordinates> coordinates;
  if (cage->textured()) coordinates = limitCoordinates(*refiner, levels, cage->coordinates);

  PolygonMesh result;
  result.materials = mesh.materials;
  result.warnings = mesh.warnings;
  constexpr uint32_t kUnused = 0xFFFFFFFFu;
  std::vector<uint32_t> index(cage->textured() ? coordinates.size() : limit.size(), kUnused);
  const Far::TopologyLevel& last = refiner->GetLevel(levels);
  for (int face = 0; face < last.GetNumFaces(); ++face) {
    const size_t parent = cageFace(*refiner, levels, face);
    if (parent >= cage->middle_faces) continue;
    const Far::ConstIndexArray corners = last.GetFaceVertices(face);
    const Far::ConstIndexArray values =
        cage->textured() ? last.GetFaceFVarValues(face) : corners;  // one vertex each
    result.face_sizes.push_back(corners.size());
    for (int k = 0; k < corners.size(); ++k) {
      const auto v = size_t(corners[k]), value = size_t(values[k]);
      if (index[value] == kUnused) {
        index[value] = uint32_t(result.positions.size());
        result.positions.push_back(limit[v].position);
        result.normals.push_back(glm::normalize(glm::cross(tangent[v].position, bitangent[v].position)));
        result.uvs.push_back(limit[v].uv);
        result.brdfs.push_back({glm::vec3(limit[v].diffuse), float(limit[v].specular.x),
                                float(limit[v].specular.y), glm::vec3(limit[v].ggx), float(limit[v].ggx.w)});
        if (cage->textured()) {
          const glm::dvec4& uvs = coordinates[value].uvs;
          result.texture_points.push_back({cage->material_of_face[parent], glm::dvec2(uvs), {uvs.z, uvs.w}});
        }
      }
      result.corners.push_back(index[value]);
    }
  }
  return result;
}

}  // namespace loden::importer
