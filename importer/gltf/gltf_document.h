// A glTF file as JSON text, so that what Loden does not know survives editing. Nothing in it is trusted: pack
// and validate read what strangers wrote. For drawing, runtime/ loads scenes through tinygltf.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "importer/gltf/json_tree.h"
#include "material/base/result.h"

namespace loden::importer {

inline constexpr const char* kExtensionName = "LODEN_materials_flat_btf";
inline constexpr const char* kAssetMimeType = "application/vnd.loden";

struct GltfDocument {
  GltfDocument() = default;
  GltfDocument(GltfDocument&&) = default;
  ~GltfDocument() { takeApart(json); }

  nlohmann::ordered_json json;  // changed by importer/gltf/json_tree.h alone
  bool binary = false;          // .glb
  std::string binary_chunk;     // of a .glb, without padding
};

// From the bytes of a .gltf or .glb file. Refuses more than 64 nested arrays and objects before parsing.
Result<GltfDocument> parseGltf(std::string_view bytes, const std::string& name);
// Complete file: JSON with two spaces of indentation, or GLB with both chunks padded to four bytes.
std::string serializeGltf(const GltfDocument& document);

// Members that are there but have not the type that glTF gives them, of those that pack edits and validate
// reads (kGltfParse); after none, they can be used without asking again.
std::vector<Issue> wrongTypes(const nlohmann::ordered_json& scene, const std::string& name);

// Index into an array member, or -1 if there is no such non-negative integer member.
int64_t integerMember(const nlohmann::ordered_json& object, const char* key);
// Elements of an array member; 0 if there is no such array.
size_t arraySize(const nlohmann::ordered_json& object, const char* key);
// Places ("meshes[0].primitives[1]") of what wears the material and lacks the vertex attribute.
std::vector<std::string> primitivesWithout(const nlohmann::ordered_json& scene, int64_t material,
                                           const std::string& attribute);

// The uri of a path relative to the document's folder, percent-encoded where needed.
std::string uriFromPath(const std::filesystem::path& relative);
bool isDataUri(std::string_view uri);
std::string base64(std::string_view bytes);
// The bytes of a base64 data uri; none if it is of another encoding, or damaged.
std::optional<std::string> bytesOfDataUri(std::string_view uri);

}  // namespace loden::importer
