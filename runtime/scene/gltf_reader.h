// Private to the glTF loader: what its source files share. The only header of the runtime that includes
// tinygltf.
#pragma once

#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

// These macros leave out tinygltf's image decoder: runtime/scene/image_decode.h decodes images.
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
  std::filesystem::path folder;  // the folder of the file
  std::string file;              // the file's name, for messages
  Scene scene = {};
  std::optional<int> variant = {};  // index of the KHR_materials_variants variant that is shown
  // One primitive: its scene mesh, and its material.
  struct Part {
    int mesh = 0, material = -1;
  };
  // The primitives of each glTF mesh.
  std::vector<std::vector<Part>> parts = {};
  struct DecodedView {
    std::vector<unsigned char> data;
    uint64_t stride = 0;
  };
  // Decompressed buffer views of EXT_meshopt_compression, by buffer view.
  std::map<int, DecodedView> decoded_views = {};
  size_t vertices = 0;  // vertices of all meshes read so far
  // Per glTF node its index in Scene::nodes; -1 if it is not part of the scene.
  std::vector<int> nodes = {};
  std::map<int, int> images = {};  // per glTF image its index in Scene::images; -1 if it cannot be drawn

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

// The bytes of a buffer view, whose range has been checked in 64-bit arithmetic.
struct View {
  const unsigned char* data = nullptr;
  uint64_t size = 0;
  uint64_t stride = 0;  // bytes between elements; 0: tightly packed
};
Result<View> readView(const Reader& reader, int view, const std::string& place);

// The issue numbers to report for data read through an accessor. The defaults are those of a mesh's
// attributes.
struct AccessorIssues {
  int missing = issue_id::kAttributeAccessor, components = issue_id::kAttributeComponents,
      finite = issue_id::kAttributeFinite, integers = issue_id::kAttributeIntegers;
  static AccessorIssues others() {
    using issue_id::kGltfAccessor;
    return {kGltfAccessor, kGltfAccessor, kGltfAccessor, kGltfAccessor};
  }
};

// The accessor's values: `components` (1..4, or 16) floats per element, from a float or normalised integer
// accessor. Every value is finite.
Result<std::vector<float>> readFloats(const Reader& reader, int accessor, int components,
                                      const std::string& place, const AccessorIssues& ids = {});
// The accessor's number of components per element; 0 if there is no such accessor.
int componentsOf(const Reader& reader, int accessor);
// The unsigned integers of a scalar accessor, each below `limit`.
Result<std::vector<uint32_t>> readIndices(const Reader& reader, int accessor, uint32_t limit,
                                          const std::string& place);

// A texture reference of a glTF material.
struct TextureReference {
  int index = -1;  // index of the document's texture; -1: none
  int tex_coord = 0;
  float scale = 1;  // scale of a normal texture
  const tinygltf::Value* transform = nullptr;
};
const tinygltf::Value* transformOf(const tinygltf::ExtensionMap& extensions);
TextureReference textureMember(const tinygltf::Value& object, const char* key);
// The texture as the renderer uses it. Its image is decoded on first use. If it cannot be drawn, a note is
// added to the scene and no texture is used.
TextureUse readTexture(Reader& reader, const TextureReference& reference, const std::string& place);

// The primitive's material in the variant that is shown; -1: glTF's default material.
int materialIndex(const Reader& reader, const tinygltf::Primitive& primitive);

// Reads the material's LODEN_materials_flat_btf extension into `binding`, if it has one.
Status readFlatBtf(const Reader& reader, const tinygltf::Material& source, const std::string& place,
                   std::optional<FlatBtfBinding>& binding);

// Each of these reads one part of the document into reader.scene. Call them in this order, since later parts
// refer to earlier ones.
Status readCompressedViews(Reader& reader);  // readView returns these views decompressed
Status readAssets(Reader& reader);
Status readMaterials(Reader& reader);
Status readMeshes(Reader& reader);
Status readVariants(Reader& reader, const std::string& shown);  // selects a variant by name; empty: none
Status readNodes(Reader& reader);                               // reads cameras and lights too
Status readSkins(Reader& reader);
Status readAnimations(Reader& reader);

// The member of an extension or extras object; nothing if it is absent or of another type.
std::optional<double> numberMember(const tinygltf::Value& object, const char* key);
std::optional<int> indexMember(const tinygltf::Value& object, const char* key);
std::string stringMember(const tinygltf::Value& object, const char* key);

}  // namespace loden::runtime::gltf
