// A glTF file as JSON, so that members that Loden does not know survive editing. Nothing in it is trusted,
// since `pack` and `validate` read untrusted files. For drawing, runtime/ loads scenes through tinygltf.
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

  nlohmann::ordered_json json;  // changed only by the functions of importer/gltf/json_tree.h
  bool binary = false;          // the file is a .glb
  std::string binary_chunk;     // binary chunk of a .glb, without padding
};

// The document in the bytes of a .gltf or .glb file. More than 64 nested arrays and objects are refused
// before parsing.
Result<GltfDocument> parseGltf(std::string_view bytes, const std::string& name);
// The bytes of the complete file: JSON with two spaces of indentation, or GLB with both chunks padded to four
// bytes.
std::string serializeGltf(const GltfDocument& document);

// An issue (kGltfParse) for each member that is present but has another JSON type than glTF gives it, among
// the members that `pack` edits and `validate` reads. If there is none, these can be used without further
// checks.
std::vector<Issue> wrongTypes(const nlohmann::ordered_json& scene, const std::string& name);

// The index that an integer member gives, or -1 if there is no such non-negative integer member.
int64_t integerMember(const nlohmann::ordered_json& object, const char* key);
// The number of elements of an array member; 0 if there is no such array.
size_t arraySize(const nlohmann::ordered_json& object, const char* key);
// The places ("meshes[0].primitives[1]") of primitives that have the material but not the vertex attribute.
std::vector<std::string> primitivesWithout(const nlohmann::ordered_json& scene, int64_t material,
                                           const std::string& attribute);

// The URI of a path relative to the document's folder, percent-encoded where needed.
std::string uriFromPath(const std::filesystem::path& relative);
bool isDataUri(std::string_view uri);
std::string base64(std::string_view bytes);
// The bytes of a base64 data URI; nothing if it has another encoding or is damaged.
std::optional<std::string> bytesOfDataUri(std::string_view uri);

}  // namespace loden::importer
