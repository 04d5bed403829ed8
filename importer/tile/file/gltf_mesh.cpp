// A tile's polygons from a glTF file. Tinygltf parses; this file checks what tinygltf does not: nesting
// depth, paths, accessor extents, required extensions, node loops.
#define TINYGLTF_NO_INCLUDE_STB_IMAGE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE_WRITE
#include <tiny_gltf.h>

#include <cmath>
#include <cstring>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <utility>

#include "importer/base/file_read.h"
#include "importer/base/image_file.h"
#include "importer/gltf/gltf_document.h"
#include "importer/tile/file/gltf_materials.h"
#include "importer/tile/polygon_mesh.h"
#include "material/base/gltf_extensions.h"
#include "material/base/issues.h"
#include "material/base/one_line.h"
#include "material/system/confined_path.h"

namespace loden::importer {
namespace {

namespace fs = std::filesystem;
constexpr int kMaxNodeDepth = 64;
constexpr size_t kMaxElements = 100'000'000;

// --- Files: only from the glTF's own folder ---------------------------------------------------------------

fs::path confined(const std::string& uri, void* folder) {
  const auto path = confinedPath(*static_cast<const fs::path*>(folder), uri, uri);
  return path ? *path : fs::path();
}
bool fileExists(const std::string& uri, void* folder) {
  std::error_code error;
  const fs::path path = confined(uri, folder);
  return !path.empty() && fs::is_regular_file(path, error);
}
bool readInto(std::vector<unsigned char>* out, std::string* error, const std::string& uri, void* folder) {
  const fs::path path = confined(uri, folder);
  const auto text = path.empty() ? Result<std::string>(Issue{}) : readFile(path);
  if (!text) {
    *error += "'" + uri + "' cannot be read from the file's folder";
    return false;
  }
  out->assign(text->begin(), text->end());
  return true;
}
std::string sameUri(const std::string& uri, void*) {
  return uri;
}
bool refuseWrite(std::string*, const std::string&, const std::vector<unsigned char>&, void*) {
  return false;
}

// --- Pictures ----------------------------------------------------------------------------------------------

constexpr uint64_t kMaxPicturePixels = uint64_t(8192) * 8192;  // of one picture
constexpr uint64_t kMaxAllPixels = 4 * kMaxPicturePixels;      // of all pictures of the file together

// What the pictures read so far come to, and what was wrong with the first that is too large.
struct PictureBudget {
  uint64_t pixels = 0;
  std::string refused;
};

// Decodes a picture unless its header asks for more than the limits. One that is no PNG or JPEG stays empty,
// which is said where a material asks for it.
bool decodePicture(tinygltf::Image* image, int index, std::string* error, std::string* warning, int width,
                   int height, const unsigned char* bytes, int size, void* user) {
  auto& budget = *static_cast<PictureBudget*>(user);
  const glm::ivec2 extents = imageExtents({bytes, size_t(std::max(size, 0))});
  const uint64_t pixels = uint64_t(std::max(extents.x, 0)) * uint64_t(std::max(extents.y, 0));
  if (pixels == 0) return true;
  if (pixels > kMaxPicturePixels || pixels > kMaxAllPixels - budget.pixels) {
    if (budget.refused.empty())
      budget.refused = "image " + std::to_string(index) + " has " + std::to_string(extents.x) + " x " +
                       std::to_string(extents.y) +
                       " pixels; at most 8192 x 8192 are read, and four times as many of all images together";
    return false;
  }
  budget.pixels += pixels;
  return tinygltf::LoadImageData(image, index, error, warning, width, height, bytes, size, nullptr);
}

// --- Accessors ---------------------------------------------------------------------------------------------

struct ComponentKind {
  size_t bytes;
  double (*read)(const unsigned char* at);
  double normaliser;  // of normalised integers, which end at -1
};

template <class Raw>
double readAs(const unsigned char* at) {
  Raw value;
  return std::memcpy(&value, at, sizeof value), double(value);
}

std::optional<ComponentKind> componentKind(int type) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return ComponentKind{1, readAs<int8_t>, 127};
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return ComponentKind{1, readAs<uint8_t>, 255};
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return ComponentKind{2, readAs<int16_t>, 32767};
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return ComponentKind{2, readAs<uint16_t>, 65535};
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return ComponentKind{4, readAs<uint32_t>, 4294967295.0};
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return ComponentKind{4, readAs<float>, 1};
    default:
      return std::nullopt;
  }
}

class GltfMeshReader {
 public:
  GltfMeshReader(const tinygltf::Model& model, const std::string& name)
      : model_(model), name_(name), materials_(model, name) {}
  Result<PolygonMesh> read();

 private:
  Status addNode(int node, const glm::dmat4& parent, int depth);
  Status addPrimitive(const tinygltf::Primitive& primitive, const glm::dmat4& world,
                      const std::string& where);
  // [element][channel] as doubles; `channels` must match.
  Result<std::vector<double>> accessor(int index, int channels, const std::string& where) const;
  Status addIndices(int index, size_t first, size_t vertices, const std::string& where);
  Status addMaterial(const tinygltf::Primitive& primitive, size_t vertices, const std::string& where);
  Result<std::vector<glm::dvec2>> textureCoordinates(const tinygltf::Primitive& primitive,
                                                     const GltfTextureUse& use, size_t vertices,
                                                     const std::string& where) const;

  Issue refuse(int id, const std::string& where, const std::string& why) const {
    return {id, Severity::kError, name_ + ": " + where, why};
  }

  const tinygltf::Model& model_;
  const std::string name_;
  GltfMaterials materials_;
  PolygonMesh mesh_;
  std::vector<bool> visited_;  // [node]
  bool without_uvs_ = false;
};

glm::dmat4 localMatrix(const tinygltf::Node& node) {
  if (node.matrix.size() == 16) return glm::make_mat4(node.matrix.data());
  glm::dmat4 m(1);
  if (node.translation.size() == 3)
    m[3] = glm::dvec4(node.translation[0], node.translation[1], node.translation[2], 1);
  if (node.rotation.size() == 4)
    m *= glm::mat4_cast(
        glm::normalize(glm::dquat(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2])));
  if (node.scale.size() == 3)
    for (int k = 0; k < 3; ++k) m[k] *= node.scale[size_t(k)];
  return m;
}

Result<PolygonMesh> GltfMeshReader::read() {
  if (model_.scenes.empty()) return refuse(issue_id::kGltfNode, "scenes", "there is no scene");
  const size_t scene = model_.defaultScene >= 0 ? size_t(model_.defaultScene) : 0;
  if (scene >= model_.scenes.size())
    return refuse(issue_id::kGltfNode, "scene", "the default scene does not exist");
  visited_.assign(model_.nodes.size(), false);
  for (const int node : model_.scenes[scene].nodes)
    if (const Status status = addNode(node, glm::dmat4(1), 0); !status) return status.issue();
  if (without_uvs_) mesh_.uvs.clear();
  mesh_.materials = std::move(materials_.textured);
  if (mesh_.materials.empty()) mesh_.texture_points.clear();
  mesh_.warnings = std::move(materials_.warnings);
  return std::move(mesh_);
}

Status GltfMeshReader::addNode(int index, const glm::dmat4& parent, int depth) {
  const std::string where = "node " + std::to_string(index);
  if (index < 0 || size_t(index) >= model_.nodes.size())
    return refuse(issue_id::kGltfNode, where, "does not exist");
  // glTF's nodes form trees: whoever is met twice is a loop, or one of the doublings that make few bytes
  // endless.
  if (visited_[size_t(index)])
    return refuse(issue_id::kGltfNode, where, "is met twice: nodes have one parent at most");
  if (depth > kMaxNodeDepth) return refuse(issue_id::kGltfNode, where, "nests too deeply");
  visited_[size_t(index)] = true;
  const tinygltf::Node& node = model_.nodes[size_t(index)];
  const glm::dmat4 world = parent * localMatrix(node);
  if (node.mesh >= 0) {
    if (size_t(node.mesh) >= model_.meshes.size())
      return refuse(issue_id::kGltfNode, where, "its mesh does not exist");
    const auto& primitives = model_.meshes[size_t(node.mesh)].primitives;
    for (size_t k = 0; k < primitives.size(); ++k)
      if (Status s = addPrimitive(primitives[k], world,
                                  "mesh " + std::to_string(node.mesh) + " primitive " + std::to_string(k));
          !s)
        return s;
  }
  for (const int child : node.children)
    if (Status s = addNode(child, world, depth + 1); !s) return s;
  return {};
}

Result<std::vector<double>> GltfMeshReader::accessor(int index, int channels,
                                                     const std::string& where) const {
  const auto bad = [&](const std::string& why) {
    return refuse(issue_id::kGltfAccessor, where + ", accessor " + std::to_string(index), why);
  };
  if (index < 0 || size_t(index) >= model_.accessors.size()) return bad("does not exist");
  const tinygltf::Accessor& a = model_.accessors[size_t(index)];
  const auto kind = componentKind(a.componentType);
  if (!kind || tinygltf::GetNumComponentsInType(uint32_t(a.type)) != channels)
    return bad("has the wrong type");
  if (a.sparse.isSparse || a.bufferView < 0) return bad("is sparse or empty; store plain data");
  if (size_t(a.bufferView) >= model_.bufferViews.size()) return bad("its buffer view does not exist");
  const tinygltf::BufferView& view = model_.bufferViews[size_t(a.bufferView)];
  if (view.buffer < 0 || size_t(view.buffer) >= model_.buffers.size())
    return bad("its buffer does not exist");
  const auto& bytes = model_.buffers[size_t(view.buffer)].data;
  if (view.byteOffset > bytes.size() || view.byteLength > bytes.size() - view.byteOffset)
    return bad("its buffer view ends behind its buffer");
  const size_t element = kind->bytes * size_t(channels), stride = view.byteStride ? view.byteStride : element;
  if (a.count == 0 || a.count > kMaxElements || stride < element || stride > 65536)
    return bad("has no elements, too many, or a bad stride");
  const uint64_t need = uint64_t(stride) * (a.count - 1) + element;
  if (a.byteOffset > view.byteLength || need > view.byteLength - a.byteOffset)
    return bad("ends behind its buffer view");
  std::vector<double> values;
  values.reserve(a.count * size_t(channels));
  const unsigned char* first = bytes.data() + view.byteOffset + a.byteOffset;
  for (size_t e = 0; e < a.count; ++e)
    for (int c = 0; c < channels; ++c) {
      const double value = kind->read(first + e * stride + size_t(c) * kind->bytes);
      values.push_back(a.normalized ? std::max(value / kind->normaliser, -1.0) : value);
    }
  return values;
}

Status GltfMeshReader::addPrimitive(const tinygltf::Primitive& primitive, const glm::dmat4& world,
                                    const std::string& where) {
  if (primitive.mode != -1 && primitive.mode != TINYGLTF_MODE_TRIANGLES)
    return refuse(issue_id::kTileGeometry, where, "is no triangle list");
  const auto attribute = [&](const char* key) {
    const auto found = primitive.attributes.find(key);
    return found == primitive.attributes.end() ? -1 : found->second;
  };
  const auto positions = accessor(attribute("POSITION"), 3, where + " POSITION");
  if (!positions) return positions.issue();
  const size_t first = mesh_.positions.size(), vertices = positions->size() / 3;
  // glTF is y up, tiles are z up.
  const auto zUp = [](const glm::dvec3& v) { return glm::dvec3(v.x, -v.z, v.y); };
  for (size_t v = 0; v < vertices; ++v)
    mesh_.positions.push_back(zUp(glm::dvec3(world * glm::dvec4(glm::make_vec3(&(*positions)[3 * v]), 1))));

  mesh_.normals.resize(first, glm::dvec3(0));
  if (attribute("NORMAL") >= 0) {
    const auto normals = accessor(attribute("NORMAL"), 3, where + " NORMAL");
    if (!normals) return normals.issue();
    if (normals->size() != positions->size())
      return refuse(issue_id::kGltfAccessor, where, "has unequal numbers of normals and positions");
    const glm::dmat3 m(world),
        cofactor(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
    const double front = glm::determinant(m) < 0 ? -1 : 1;  // a mirror keeps normals on their side
    for (size_t v = 0; v < vertices; ++v)
      mesh_.normals.push_back(zUp(front * cofactor * glm::make_vec3(&(*normals)[3 * v])));
  }
  mesh_.normals.resize(first + vertices, glm::dvec3(0));

  mesh_.uvs.resize(first, glm::dvec2(0));
  if (attribute("TEXCOORD_0") >= 0) {
    const auto uvs = accessor(attribute("TEXCOORD_0"), 2, where + " TEXCOORD_0");
    if (!uvs) return uvs.issue();
    if (uvs->size() != 2 * vertices)
      return refuse(issue_id::kGltfAccessor, where,
                    "has unequal numbers of texture coordinates and positions");
    for (size_t v = 0; v < vertices; ++v) mesh_.uvs.push_back({(*uvs)[2 * v], (*uvs)[2 * v + 1]});
  } else {
    without_uvs_ = true;
  }
  mesh_.uvs.resize(first + vertices, glm::dvec2(0));
  const size_t first_corner = mesh_.corners.size();
  if (Status s = addIndices(primitive.indices, first, vertices, where); !s) return s;
  if (glm::determinant(glm::dmat3(world)) < 0)  // a mirror: glTF turns the triangles with it
    for (size_t k = first_corner; k < mesh_.corners.size(); k += 3)
      std::swap(mesh_.corners[k + 1], mesh_.corners[k + 2]);
  return addMaterial(primitive, vertices, where);
}

Status GltfMeshReader::addIndices(int index, size_t first, size_t vertices, const std::string& where) {
  std::vector<double> indices;
  if (index >= 0) {
    auto read = accessor(index, 1, where + " indices");
    if (!read) return read.issue();
    indices = std::move(*read);
  } else {
    for (size_t v = 0; v < vertices; ++v) indices.push_back(double(v));
  }
  if (indices.size() % 3)
    return refuse(issue_id::kTileGeometry, where, "its number of indices is no multiple of 3");
  for (size_t k = 0; k < indices.size(); ++k) {
    if (!(indices[k] >= 0 && indices[k] < double(vertices)))
      return refuse(issue_id::kGltfAccessor, where + ", triangle " + std::to_string(k / 3),
                    "names a vertex that does not exist");
    mesh_.corners.push_back(uint32_t(first + size_t(indices[k])));
  }
  mesh_.face_sizes.insert(mesh_.face_sizes.end(), indices.size() / 3, 3);
  return {};
}

Status GltfMeshReader::addMaterial(const tinygltf::Primitive& primitive, size_t vertices,
                                   const std::string& where) {
  const auto found = materials_.at(primitive.material);
  if (!found) return found.issue();
  const GltfMaterial& material = **found;
  if (primitive.attributes.contains("COLOR_0"))
    materials_.warn(where + ", " + material.label,
                    "COLOR_0 is not baked; put the vertices' colours into a base colour texture");
  mesh_.brdfs.insert(mesh_.brdfs.end(), vertices, material.brdf);
  const size_t first = mesh_.texture_points.size();
  mesh_.texture_points.resize(first + vertices);
  if (material.index == TexturePoint::kNone) return {};
  const auto base_color = textureCoordinates(primitive, material.base_color, vertices, where);
  if (!base_color) return base_color.issue();
  const auto metallic_roughness = textureCoordinates(primitive, material.metallic_roughness, vertices, where);
  if (!metallic_roughness) return metallic_roughness.issue();
  for (size_t v = 0; v < vertices; ++v)
    mesh_.texture_points[first + v] = {material.index, (*base_color)[v], (*metallic_roughness)[v]};
  return {};
}

// Of all vertices; 0 if there is no texture.
Result<std::vector<glm::dvec2>> GltfMeshReader::textureCoordinates(const tinygltf::Primitive& primitive,
                                                                   const GltfTextureUse& use, size_t vertices,
                                                                   const std::string& where) const {
  std::vector<glm::dvec2> coordinates(vertices, glm::dvec2(0));
  if (use.set < 0) return coordinates;
  const std::string attribute = "TEXCOORD_" + std::to_string(use.set);
  const auto found = primitive.attributes.find(attribute);
  if (found == primitive.attributes.end())
    return refuse(issue_id::kGltfAccessor, where,
                  "has no " + attribute + ", which a texture of its material asks for");
  const auto read = accessor(found->second, 2, where + " " + attribute);
  if (!read) return read.issue();
  if (read->size() != 2 * vertices)
    return refuse(issue_id::kGltfAccessor, where, "has unequal numbers of texture coordinates and positions");
  for (size_t v = 0; v < vertices; ++v)
    coordinates[v] = glm::dvec2(use.transform * glm::dvec3((*read)[2 * v], (*read)[2 * v + 1], 1));
  return coordinates;
}

// What the runtime's scenes may require, and what tiles have besides.
bool isReadable(std::string_view extension) {
  return isSupportedGltfExtension(extension) || extension == kTextureTransform;
}

Status checkRequired(const nlohmann::ordered_json& json, const std::string& name) {
  for (size_t k = 0; k < arraySize(json, "extensionsRequired"); ++k) {
    const nlohmann::ordered_json& extension = json["extensionsRequired"][k];
    if (extension.is_string() && isReadable(extension.get_ref<const std::string&>())) continue;
    return Issue{issue_id::kGltfRequired, Severity::kError, name + ": extensionsRequired",
                 extension.dump() + " is needed to read this file and not supported; export without"};
  }
  return {};
}

}  // namespace

Result<PolygonMesh> readGltfMesh(const fs::path& path) {
  const std::string name = path.string();
  const auto bytes = readFile(path);
  if (!bytes) return bytes.issue();
  const auto document = parseGltf(*bytes, name);  // nesting depth, before tinygltf sees the text
  if (!document) return document.issue();
  if (const Status status = checkRequired(document->json, name); !status) return status.issue();

  fs::path folder = path.parent_path().empty() ? fs::path(".") : path.parent_path();
  tinygltf::TinyGLTF loader;
  loader.SetFsCallbacks({fileExists, sameUri, readInto, refuseWrite, &folder});
  PictureBudget pictures;
  loader.SetImageLoader(decodePicture, &pictures);
  tinygltf::Model model;
  std::string error, warning;
  const auto size = static_cast<unsigned>(bytes->size());
  bool loaded = false;
  try {
    loaded = document->binary
                 ? loader.LoadBinaryFromMemory(&model, &error, &warning,
                                               reinterpret_cast<const unsigned char*>(bytes->data()), size)
                 : loader.LoadASCIIFromString(&model, &error, &warning, bytes->data(), size, "");
  } catch (const std::exception& thrown) {
    error = thrown.what();
  }
  if (!pictures.refused.empty())
    return Issue{issue_id::kTileMaterial, Severity::kError, name, pictures.refused};
  // An error beside a loaded file: what stands behind it in the same object was not read.
  if (!loaded || !error.empty())
    return Issue{issue_id::kGltfParse, Severity::kError, name, "cannot be read as glTF: " + oneLine(error)};
  return GltfMeshReader(model, name).read();
}

}  // namespace loden::importer
