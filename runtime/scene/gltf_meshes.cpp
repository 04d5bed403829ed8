// Meshes: one scene mesh per triangle primitive.
#include <numeric>

#include "runtime/scene/gltf_reader.h"
#include "runtime/scene/limit_surface.h"

namespace loden::runtime::gltf {
namespace {

constexpr size_t kMaxVertices = size_t(1) << 26;  // per mesh

int attribute(const tinygltf::Primitive& primitive, const std::string& name) {
  const auto found = primitive.attributes.find(name);
  return found == primitive.attributes.end() ? -1 : found->second;
}

// The UV set that the primitive's material reads.
std::string uvName(const Reader& reader, const tinygltf::Primitive& primitive) {
  int set = 0;
  if (primitive.material >= 0 && reader.scene.materials[primitive.material].flat_btf)
    set = reader.scene.materials[primitive.material].flat_btf->tex_coord;
  return "TEXCOORD_" + std::to_string(set);
}

// One attribute, which must have as many elements as there are vertices, handed to `store` element by
// element.
template <int kComponents, class Store>
Status readAttribute(const Reader& reader, int accessor, const std::string& place,
                     std::vector<Vertex>& vertices, const Store& store) {
  const auto values = readFloats(reader, accessor, kComponents, place);
  if (!values) return values.issue();
  if (values->size() != vertices.size() * kComponents)
    return reader.issue(issue_id::kGltfAccessor, place,
                        "has " + std::to_string(values->size() / kComponents) + " elements for " +
                            std::to_string(vertices.size()) + " vertices");
  for (size_t i = 0; i < vertices.size(); ++i) store(vertices[i], values->data() + i * kComponents);
  return {};
}

Status readPositions(const Reader& reader, const tinygltf::Primitive& primitive, const std::string& place,
                     Mesh& mesh) {
  const auto positions =
      readFloats(reader, attribute(primitive, "POSITION"), 3, place + ".attributes.POSITION");
  if (!positions) return positions.issue();
  if (positions->size() / 3 > kMaxVertices)
    return reader.issue(issue_id::kGltfAccessor, place, "too many vertices");
  mesh.vertices.resize(positions->size() / 3);
  for (size_t i = 0; i < mesh.vertices.size(); ++i)
    mesh.vertices[i].position = {(*positions)[3 * i], (*positions)[3 * i + 1], (*positions)[3 * i + 2]};
  return {};
}

Status readTriangles(const Reader& reader, const tinygltf::Primitive& primitive, const std::string& place,
                     Mesh& mesh) {
  const auto count = static_cast<uint32_t>(mesh.vertices.size());
  if (primitive.indices >= 0) {
    auto indices = readIndices(reader, primitive.indices, count, place + ".indices");
    if (!indices) return indices.issue();
    mesh.indices = *std::move(indices);
  } else {
    mesh.indices.resize(count);
    std::iota(mesh.indices.begin(), mesh.indices.end(), 0u);
  }
  if (mesh.indices.size() % 3 != 0)
    return reader.issue(issue_id::kGltfAccessor, place, "the number of indices is no multiple of 3");
  return {};
}

Status readNormals(const Reader& reader, const tinygltf::Primitive& primitive, const std::string& place,
                   Mesh& mesh) {
  const int accessor = attribute(primitive, "NORMAL");
  if (accessor < 0) return computeNormals(mesh), Status();
  return readAttribute<3>(reader, accessor, place + ".attributes.NORMAL", mesh.vertices,
                          [](Vertex& vertex, const float* v) {
                            const glm::vec3 normal(v[0], v[1], v[2]);
                            const float length = glm::length(normal);
                            vertex.normal = length > 0 ? normal / length : glm::vec3(0, 1, 0);
                          });
}

Status readUvs(const Reader& reader, const tinygltf::Primitive& primitive, const std::string& place,
               Mesh& mesh) {
  const std::string name = uvName(reader, primitive);
  const int accessor = attribute(primitive, name);
  if (accessor < 0) return {};
  return readAttribute<2>(reader, accessor, place + ".attributes." + name, mesh.vertices,
                          [](Vertex& vertex, const float* v) {
                            vertex.uv = {v[0], v[1]};
                          });
}

// glTF's tangents belong to TEXCOORD_0 of normal maps, whose v runs downwards.
Status readTangents(const Reader& reader, const tinygltf::Primitive& primitive, const std::string& place,
                    Mesh& mesh) {
  const int accessor = attribute(primitive, "TANGENT");
  if (accessor < 0 || uvName(reader, primitive) != "TEXCOORD_0") return computeTangents(mesh), Status();
  return readAttribute<4>(reader, accessor, place + ".attributes.TANGENT", mesh.vertices,
                          [](Vertex& vertex, const float* v) {
                            const glm::vec3 tangent(v[0], v[1], v[2]);
                            const float length = glm::length(tangent);
                            if (length > 0) vertex.tangent = {tangent / length, v[3] > 0 ? -1.0f : 1.0f};
                          });
}

// What a mesh's extras ask for; nothing if they do not.
struct Subdivision {
  int levels = 3;
};
Result<std::optional<Subdivision>> readSubdivision(const Reader& reader, const tinygltf::Value& extras,
                                                   const std::string& place) {
  using Answer = std::optional<Subdivision>;
  if (!extras.IsObject() || !extras.Has("loden_subdivision")) return Answer();
  const tinygltf::Value& object = extras.Get("loden_subdivision");
  const std::optional<int> levels = indexMember(object, "levels");
  const bool quads = object.IsObject() && object.Has("quads") && object.Get("quads").IsBool() &&
                     object.Get("quads").Get<bool>();
  if (!levels || *levels < 1 || *levels > kMaxLimitLevels || !quads)
    return reader.issue(issue_id::kGltfExtension, place + ".extras.loden_subdivision",
                        "needs \"levels\" 1 .. " + std::to_string(kMaxLimitLevels) + " and \"quads\": true");
  return Answer(Subdivision{*levels});
}

Status readPrimitive(Reader& reader, size_t mesh_index, size_t index) {
  const tinygltf::Mesh& source = reader.model.meshes[mesh_index];
  const tinygltf::Primitive& primitive = source.primitives[index];
  const std::string place = at("meshes", mesh_index) + "." + at("primitives", index);
  if (primitive.mode != TINYGLTF_MODE_TRIANGLES && primitive.mode != -1)
    return reader.note(issue_id::kGltfAccessor, place, "is no triangle list, and is left out"), Status();
  if (primitive.material < -1 || primitive.material >= static_cast<int>(reader.scene.materials.size()))
    return reader.issue(issue_id::kGltfAccessor, place, "material does not exist");

  Mesh mesh;
  mesh.name = source.name;
  for (auto* read : {&readPositions, &readTriangles, &readNormals, &readUvs, &readTangents})
    if (Status status = read(reader, primitive, place, mesh); !status) return status;
  const auto subdivision = readSubdivision(reader, source.extras, at("meshes", mesh_index));
  if (!subdivision) return subdivision.issue();
  if (*subdivision) {
    auto limit = limitSurface(mesh, (*subdivision)->levels, reader.file + ": " + place);
    if (!limit) return limit.issue();
    mesh = *std::move(limit);
  }
  mesh.bounds = boundsOf(mesh);
  reader.parts[mesh_index].push_back({static_cast<int>(reader.scene.meshes.size()), primitive.material});
  reader.scene.meshes.push_back(std::move(mesh));
  return {};
}

}  // namespace

Status readMeshes(Reader& reader) {
  reader.parts.resize(reader.model.meshes.size());
  for (size_t i = 0; i < reader.model.meshes.size(); ++i)
    for (size_t j = 0; j < reader.model.meshes[i].primitives.size(); ++j)
      if (Status status = readPrimitive(reader, i, j); !status) return status;
  return {};
}

}  // namespace loden::runtime::gltf
