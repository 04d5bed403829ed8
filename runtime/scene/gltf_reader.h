// Private to the glTF loader: what its parts share. The only header of the runtime that names tinygltf.
#pragma once

#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

// The packaged library decodes no image for us, and needs no stb here.
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE_WRITE
#include <tiny_gltf.h>

#include "material/base/issues.h"
#include "material/base/result.h"
#include "runtime/scene/scene.h"

namespace loden::runtime::gltf {

// A parsed document and the scene under construction.
struct Reader {
  const tinygltf::Model& model;
  std::filesystem::path folder;  // of the file
  std::string file;              // for messages
  Scene scene = {};
  std::optional<int> variant = {};  // of the materials, that is shown
  // Scene meshes of each glTF mesh, with their materials.
  struct Part {
    int mesh = 0, material = -1;
  };
  std::vector<std::vector<Part>> parts = {};
  struct DecodedView {
    std::vector<unsigned char> data;
    uint64_t stride = 0;
  };
  std::map<int, DecodedView> decoded_views = {};  // of EXT_meshopt_compression, by buffer view
  size_t vertices = 0;                            // of all meshes so far
  std::vector<int> nodes = {};     // glTF node to index into Scene::nodes; -1 if it is not part of the scene
  std::map<int, int> images = {};  // glTF image to index into Scene::images; -1 if it cannot be drawn

  Issue issue(int id, const std::string& place, std::string text) const {
    return {id, Severity::kError, file + ": " + place, std::move(text)};
  }
  void note(int id, const std::string& place, std::string text) {
    scene.notes.push_back({id, Severity::kWarning, file + ": " + place, std::move(text)});
  }
};

inline std::string at(const std::string& array, size_t index) {
  return array + "[" + std::to_string(index) + "]";
}

// The bytes of a buffer view, checked in 64 bit.
struct View {
  const unsigned char* data = nullptr;
  uint64_t size = 0;
  uint64_t stride = 0;  // 0: packed
};
Result<View> readView(const Reader& reader, int view, const std::string& place);

// The issues of what is read through an accessor; the defaults are those of a mesh's attributes.
struct AccessorIssues {
  int missing = issue_id::kAttributeAccessor, components = issue_id::kAttributeComponents,
      finite = issue_id::kAttributeFinite, integers = issue_id::kAttributeIntegers;
  static AccessorIssues others() {
    using issue_id::kGltfAccessor;
    return {kGltfAccessor, kGltfAccessor, kGltfAccessor, kGltfAccessor};
  }
};

// `components` (1..4, or 16) floats per element, of a float or normalised integer accessor; every value
// finite.
Result<std::vector<float>> readFloats(const Reader& reader, int accessor, int components,
                                      const std::string& place, const AccessorIssues& ids = {});
// Components per element; 0 if there is no such accessor.
int componentsOf(const Reader& reader, int accessor);
// Unsigned integers of a scalar accessor, each below `limit`.
Result<std::vector<uint32_t>> readIndices(const Reader& reader, int accessor, uint32_t limit,
                                          const std::string& place);

// A texture as a material names it.
struct TextureReference {
  int index = -1;  // of the document's textures; -1: none
  int tex_coord = 0;
  float scale = 1;  // of normal textures
  const tinygltf::Value* transform = nullptr;
};
const tinygltf::Value* transformOf(const tinygltf::ExtensionMap& extensions);
TextureReference textureMember(const tinygltf::Value& object, const char* key);
// Decodes the image if it is the first to ask. What cannot be drawn is noted, and none is used.
TextureUse readTexture(Reader& reader, const TextureReference& reference, const std::string& place);

// The primitive's material in the variant that is shown; -1: glTF's default material.
int materialIndex(const Reader& reader, const tinygltf::Primitive& primitive);

// The material's LODEN_materials_flat_btf, if it has one.
Status readFlatBtf(const Reader& reader, const tinygltf::Material& source, const std::string& place,
                   std::optional<FlatBtfBinding>& binding);

// Parts of the document, in the order in which they depend on each other.
Status readCompressedViews(Reader& reader);  // which readView then returns decompressed
Status readAssets(Reader& reader);
Status readMaterials(Reader& reader);
Status readMeshes(Reader& reader);
Status readVariants(Reader& reader, const std::string& shown);  // by name; empty: none
Status readNodes(Reader& reader);  // with the cameras and lights that hang on them
Status readSkins(Reader& reader);
Status readAnimations(Reader& reader);

// Members of extension and extras objects; nothing if absent or of another type.
std::optional<double> numberMember(const tinygltf::Value& object, const char* key);
std::optional<int> indexMember(const tinygltf::Value& object, const char* key);
std::string stringMember(const tinygltf::Value& object, const char* key);

}  // namespace loden::runtime::gltf
