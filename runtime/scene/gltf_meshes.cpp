// Meshes: one scene mesh per triangle primitive.
#include <algorithm>
#include <map>
#include <numeric>

#include "runtime/scene/gltf_reader.h"
#include "runtime/scene/limit_surface.h"

namespace loden::runtime::gltf {
namespace {

constexpr size_t kMaxVertices = size_t(1) << 26;  // of a scene

int attribute(const tinygltf::Primitive& primitive, const std::string& name) {
  const auto found = primitive.attributes.find(name);
  return found == primitive.attributes.end() ? -1 : found->second;
}

bool isStripOrFan(const tinygltf::Primitive& primitive) {
  return primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP || primitive.mode == TINYGLTF_MODE_TRIANGLE_FAN;
}

// Null: glTF's default material.
const SceneMaterial* materialOf(const Reader& reader, const tinygltf::Primitive& primitive) {
  const int index = materialIndex(reader, primitive);
  return index >= 0 ? &reader.scene.materials[size_t(index)] : nullptr;
}

// The UV set that the primitive's tangents follow.
std::string uvName(const Reader& reader, const tinygltf::Primitive& primitive) {
  int set = 0;
  if (const SceneMaterial* material = materialOf(reader, primitive)) {
    set = material->texture(TextureRole::kNormal).tex_coord;
    if (material->flat_btf) set = material->flat_btf->tex_coord;
  }
  return "TEXCOORD_" + std::to_string(set);
}

// The floats of one attribute, which must have as many elements as there are vertices; nothing if the
// primitive has not got it.
Result<std::vector<float>> readAttribute(const Reader& reader, const tinygltf::Primitive& primitive,
                                         const std::string& name, int components, const std::string& place,
                                         const Mesh& mesh) {
  const int accessor = attribute(primitive, name);
  if (accessor < 0) return std::vector<float>();
  auto values = readFloats(reader, accessor, components, place + ".attributes." + name);
  if (values && values->size() != mesh.vertices.size() * size_t(components))
    return reader.issue(issue_id::kAttributeCount, place + ".attributes." + name,
                        "has " + std::to_string(values->size() / size_t(components)) + " elements for " +
                            std::to_string(mesh.vertices.size()) + " vertices");
  return values;
}

Status readPositions(const Reader& reader, const tinygltf::Primitive& primitive, const std::string& place,
                     Mesh& mesh) {
  if (attribute(primitive, "POSITION") < 0)
    return reader.issue(issue_id::kNoPosition, place, "has no attribute POSITION");
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

// Strips and fans as lists; triangles of a strip keep their winding.
std::vector<uint32_t> triangleList(const std::vector<uint32_t>& indices, int mode) {
  std::vector<uint32_t> list;
  for (size_t i = 2; i < indices.size(); ++i) {
    const uint32_t a = mode == TINYGLTF_MODE_TRIANGLE_FAN ? indices[0] : indices[i - 2], b = indices[i - 1],
                   c = indices[i];
    const bool odd = mode == TINYGLTF_MODE_TRIANGLE_STRIP && i % 2 == 1;
    list.insert(list.end(), {odd ? b : a, odd ? a : b, c});
  }
  return list;
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
  if (isStripOrFan(primitive)) mesh.indices = triangleList(mesh.indices, primitive.mode);
  if (mesh.indices.size() % 3 != 0)
    return reader.issue(issue_id::kTriangleCorners, place, "the number of indices is no multiple of 3");
  if (mesh.indices.size() > 3 * kMaxVertices)
    return reader.issue(issue_id::kGltfAccessor, place, "too many triangles");
  return {};
}

// Without normals each triangle is flat, as glTF says; surfaces with a Loden material are smooth.
Status readNormals(const Reader& reader, const tinygltf::Primitive& primitive, const std::string& place,
                   Mesh& mesh) {
  const auto normals = readAttribute(reader, primitive, "NORMAL", 3, place, mesh);
  if (!normals) return normals.issue();
  for (size_t i = 0; 3 * i < normals->size(); ++i) {
    const glm::vec3 normal((*normals)[3 * i], (*normals)[3 * i + 1], (*normals)[3 * i + 2]);
    const float length = glm::length(normal);
    mesh.vertices[i].normal = length > 0 ? normal / length : glm::vec3(0, 1, 0);
  }
  if (!normals->empty()) return {};
  const SceneMaterial* material = materialOf(reader, primitive);
  if (!material || !material->flat_btf) separateTriangles(mesh);
  computeNormals(mesh);
  return {};
}

Status readUvs(const Reader& reader, const tinygltf::Primitive& primitive, const std::string& place,
               Mesh& mesh) {
  const auto uvs = readAttribute(reader, primitive, uvName(reader, primitive), 2, place, mesh);
  if (!uvs) return uvs.issue();
  for (size_t i = 0; 2 * i < uvs->size(); ++i) mesh.vertices[i].uv = {(*uvs)[2 * i], (*uvs)[2 * i + 1]};
  for (size_t set = 0; set < kUvSets; ++set) {
    const auto values = readAttribute(reader, primitive, "TEXCOORD_" + std::to_string(set), 2, place, mesh);
    if (!values) return values.issue();
    for (size_t i = 0; 2 * i < values->size(); ++i)
      mesh.uv_sets[set].emplace_back((*values)[2 * i], (*values)[2 * i + 1]);
  }
  return {};
}

// Of three components or four.
Status readColors(const Reader& reader, const tinygltf::Primitive& primitive, const std::string& place,
                  Mesh& mesh) {
  const int accessor = attribute(primitive, "COLOR_0");
  if (accessor < 0) return {};
  const size_t n = size_t(componentsOf(reader, accessor)) == 3 ? 3 : 4;
  const auto values = readAttribute(reader, primitive, "COLOR_0", int(n), place, mesh);
  if (!values) return values.issue();
  for (size_t i = 0; n * i < values->size(); ++i) {
    const float* v = values->data() + n * i;
    mesh.colors.push_back(glm::clamp(glm::vec4(v[0], v[1], v[2], n == 4 ? v[3] : 1.0f), 0.0f, 1.0f));
  }
  return {};
}

constexpr size_t kMaxTargets = 1024;  // per mesh
constexpr size_t kJointSets = 2;      // JOINTS_0 and JOINTS_1

// Of JOINTS_n and WEIGHTS_n; weights are scaled to sum to 1.
Status readInfluences(const Reader& reader, const tinygltf::Primitive& primitive, const std::string& place,
                      Mesh& mesh) {
  for (size_t set = 0; set < kJointSets; ++set) {
    const std::string number = std::to_string(set);
    const auto joints = readAttribute(reader, primitive, "JOINTS_" + number, 4, place, mesh);
    if (!joints) return joints.issue();
    const auto weights = readAttribute(reader, primitive, "WEIGHTS_" + number, 4, place, mesh);
    if (!weights) return weights.issue();
    if (joints->empty() || weights->empty()) break;
    mesh.influences.resize(mesh.vertices.size());
    for (size_t i = 0; i < joints->size(); ++i) {
      Influences& influences = mesh.influences[i / 4];
      influences.joints[4 * set + i % 4] = static_cast<uint16_t>(std::clamp((*joints)[i], 0.0f, 65535.0f));
      influences.weights[4 * set + i % 4] = std::max((*weights)[i], 0.0f);
    }
  }
  for (Influences& influences : mesh.influences) {
    const float sum = std::accumulate(influences.weights.begin(), influences.weights.end(), 0.0f);
    if (sum > 0)
      for (float& weight : influences.weights) weight /= sum;
    else
      influences.weights[0] = 1;
  }
  return {};
}

// Three numbers per vertex that a morph target adds to an attribute; nothing if it does not.
Result<std::vector<glm::vec3>> readDeltas(const Reader& reader, const std::map<std::string, int>& target,
                                          const std::string& name, const std::string& place, size_t count) {
  std::vector<glm::vec3> deltas;
  const auto found = target.find(name);
  if (found == target.end()) return deltas;
  const auto values = readFloats(reader, found->second, 3, place + "." + name);
  if (!values) return values.issue();
  if (values->size() != 3 * count)
    return reader.issue(issue_id::kAttributeCount, place + "." + name,
                        "has not as many elements as vertices");
  for (size_t i = 0; i < values->size(); i += 3)
    deltas.emplace_back((*values)[i], (*values)[i + 1], (*values)[i + 2]);
  return deltas;
}

Status readTargets(const Reader& reader, const tinygltf::Primitive& primitive, const std::string& place,
                   Mesh& mesh) {
  if (primitive.targets.size() > kMaxTargets ||
      primitive.targets.size() * mesh.vertices.size() > kMaxVertices)
    return reader.issue(issue_id::kGltfAccessor, place, "has too many morph targets");
  for (size_t k = 0; k < primitive.targets.size(); ++k) {
    MorphTarget target;
    const auto read = [&](const char* name, std::vector<glm::vec3>& deltas) -> Status {
      auto values = readDeltas(reader, primitive.targets[k], name, place + "." + at("targets", k),
                               mesh.vertices.size());
      if (!values) return values.issue();
      deltas = *std::move(values);
      return {};
    };
    if (Status status = read("POSITION", target.positions); !status) return status;
    if (Status status = read("NORMAL", target.normals); !status) return status;
    if (Status status = read("TANGENT", target.tangents); !status) return status;
    mesh.targets.push_back(std::move(target));
  }
  return {};
}

// glTF's tangents belong to TEXCOORD_0 of normal maps, whose v runs downwards.
Status readTangents(const Reader& reader, const tinygltf::Primitive& primitive, const std::string& place,
                    Mesh& mesh) {
  const bool usable = attribute(primitive, "NORMAL") >= 0 && uvName(reader, primitive) == "TEXCOORD_0";
  if (!usable || attribute(primitive, "TANGENT") < 0) return computeTangents(mesh), Status();
  const auto tangents = readAttribute(reader, primitive, "TANGENT", 4, place, mesh);
  if (!tangents) return tangents.issue();
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    const float* v = tangents->data() + 4 * i;
    const glm::vec3 tangent(v[0], v[1], v[2]);
    const float length = glm::length(tangent);
    if (length > 0) mesh.vertices[i].tangent = {tangent / length, v[3] > 0 ? -1.0f : 1.0f};
  }
  return {};
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
    return reader.issue(issue_id::kSubdivision, place + ".extras.loden_subdivision",
                        "needs \"levels\" 1 .. " + std::to_string(kMaxLimitLevels) + " and \"quads\": true");
  return Answer(Subdivision{*levels});
}

// A limit surface has one set of texture coordinates: it stands for the set that it was made from.
void copyUvSet(const Reader& reader, const tinygltf::Primitive& primitive, Mesh& mesh) {
  const std::string name = uvName(reader, primitive);
  for (size_t set = 0; set < kUvSets; ++set)
    if (name == "TEXCOORD_" + std::to_string(set))
      for (const Vertex& vertex : mesh.vertices) mesh.uv_sets[set].push_back(vertex.uv);
}

Status readPrimitive(Reader& reader, size_t mesh_index, size_t index) {
  const tinygltf::Mesh& source = reader.model.meshes[mesh_index];
  const tinygltf::Primitive& primitive = source.primitives[index];
  const std::string place = at("meshes", mesh_index) + "." + at("primitives", index);
  if (primitive.mode != TINYGLTF_MODE_TRIANGLES && primitive.mode != -1 && !isStripOrFan(primitive))
    return reader.note(issue_id::kGltfAccessor, place, "is made of points or lines, and is not drawn"),
           Status();
  const int material = materialIndex(reader, primitive);
  if (material < -1 || material >= static_cast<int>(reader.scene.materials.size()))
    return reader.issue(issue_id::kPrimitiveMaterial, place, "material does not exist");

  Mesh mesh;
  mesh.name = source.name;
  const auto subdivision = readSubdivision(reader, source.extras, at("meshes", mesh_index));
  if (!subdivision) return subdivision.issue();
  for (auto* read : {&readPositions, &readTriangles, &readUvs, &readColors, &readInfluences, &readTargets})
    if (Status status = read(reader, primitive, place, mesh); !status) return status;
  // Normals of a cage are those of its limit surface, and its quads must stay in one piece.
  for (auto* read : {&readNormals, &readTangents})
    if (!*subdivision)
      if (Status status = read(reader, primitive, place, mesh); !status) return status;
  if (*subdivision) {
    auto limit = limitSurface(mesh, (*subdivision)->levels, reader.file + ": " + place);
    if (!limit) return limit.issue();
    mesh = *std::move(limit);
    copyUvSet(reader, primitive, mesh);
  }
  mesh.bounds = boundsOf(mesh);
  reader.vertices += mesh.vertices.size();
  if (reader.vertices > kMaxVertices)
    return reader.issue(issue_id::kGltfAccessor, place, "the scene has too many vertices");
  reader.parts[mesh_index].push_back({static_cast<int>(reader.scene.meshes.size()), material});
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
