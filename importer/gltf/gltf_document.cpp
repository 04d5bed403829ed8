#include "importer/gltf/gltf_document.h"

#include <cstdint>
#include <cstring>

#include "material/base/issues.h"
#include "material/base/json_depth.h"

namespace loden::importer {
namespace {

constexpr uint32_t kGlbMagic = 0x46546C67, kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;

Issue issueAt(int id, const std::string& name, const std::string& text) {
  return {id, Severity::kError, name, text};
}

uint32_t u32At(std::string_view bytes, size_t at) {
  uint32_t value = 0;
  for (int i = 0; i < 4; ++i) value |= uint32_t{static_cast<unsigned char>(bytes[at + i])} << (8 * i);
  return value;
}

void appendU32(std::string& bytes, uint32_t value) {
  for (int i = 0; i < 4; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xFF);
}

// Splits a GLB; `json` points into `bytes`.
Status splitGlb(std::string_view bytes, const std::string& name, std::string_view& json,
                std::string& binary_chunk) {
  const auto broken = [&](int id, const std::string& text) { return issueAt(id, name, text); };
  if (u32At(bytes, 4) != 2) return broken(issue_id::kGlbVersion, "GLB version is not 2");
  if (u32At(bytes, 8) != bytes.size())
    return broken(issue_id::kGlbLength, "GLB header says " + std::to_string(u32At(bytes, 8)) +
                                            " bytes, the file has " + std::to_string(bytes.size()));
  size_t at = 12;
  for (int chunk = 0; at < bytes.size(); ++chunk) {
    if (bytes.size() - at < 8) return broken(issue_id::kGlbTruncated, "GLB ends inside a chunk header");
    const uint32_t length = u32At(bytes, at), type = u32At(bytes, at + 4);
    if (length > bytes.size() - at - 8)
      return broken(issue_id::kGlbChunk, "GLB chunk " + std::to_string(chunk) + " is longer than the file");
    if (chunk == 0 && type != kJsonChunk)
      return broken(issue_id::kGlbNoJson, "the first GLB chunk is not JSON");
    if (chunk == 0) json = bytes.substr(at + 8, length);
    if (chunk == 1 && type == kBinaryChunk) binary_chunk = bytes.substr(at + 8, length);
    at += 8 + size_t{length};
  }
  return {};
}

// asset.version; empty if that is no string.
std::string_view versionOf(const nlohmann::ordered_json& scene) {
  const auto asset = scene.find("asset");
  if (asset == scene.end() || !asset->is_object()) return {};
  const auto version = asset->find("version");
  return version != asset->end() && version->is_string() ? version->get_ref<const std::string&>()
                                                         : std::string_view();
}

int base64Digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' ? 62 : c == '/' ? 63 : -1;
}

// Collects members of another type than expected, with their place.
class TypeCheck {
 public:
  using Json = nlohmann::ordered_json;
  explicit TypeCheck(const std::string& name) : name_(name) {}

  void list(const Json& object, const std::string& place, const char* key,
            bool (Json::*type)() const noexcept, const char* wanted) {
    const Json* items = member(object, place, key, &Json::is_array, "an array");
    for (size_t i = 0; items && i < items->size(); ++i)
      expect((*items)[i], place + key + "[" + std::to_string(i) + "]", type, wanted);
  }
  // The member if it is there and of the type.
  const Json* member(const Json& object, const std::string& place, const char* key,
                     bool (Json::*type)() const noexcept, const char* wanted) {
    if (!object.is_object()) return nullptr;  // said of the object itself
    const auto found = object.find(key);
    if (found == object.end() || !expect(*found, place + key, type, wanted)) return nullptr;
    return &*found;
  }
  std::vector<Issue> issues;

 private:
  bool expect(const Json& value, const std::string& place, bool (Json::*type)() const noexcept,
              const char* wanted) {
    if ((value.*type)()) return true;
    issues.push_back(issueAt(issue_id::kGltfType, name_ + ": " + place,
                             std::string("must be ") + wanted + ", not " + value.type_name()));
    return false;
  }

  const std::string& name_;
};

}  // namespace

std::vector<Issue> wrongTypes(const nlohmann::ordered_json& scene, const std::string& name) {
  using Json = nlohmann::ordered_json;
  TypeCheck check(name);
  for (const char* list :
       {"materials", "meshes", "buffers", "bufferViews", "images", "textures", "samplers", "accessors"})
    check.list(scene, "", list, &Json::is_object, "an object");
  for (const char* list : {"extensionsUsed", "extensionsRequired"})
    check.list(scene, "", list, &Json::is_string, "a string");
  const auto eachOf = [&](const char* list, const auto& visit) {
    for (size_t i = 0; i < arraySize(scene, list); ++i)
      visit(scene[list][i], std::string(list) + "[" + std::to_string(i) + "].");
  };
  eachOf("materials", [&](const Json& material, const std::string& place) {
    check.member(material, place, "name", &Json::is_string, "a string");
    check.member(material, place, "extensions", &Json::is_object, "an object");
  });
  for (const char* list : {"buffers", "images"})
    eachOf(list, [&](const Json& item, const std::string& place) {
      check.member(item, place, "uri", &Json::is_string, "a string");
    });
  if (const Json* extensions = check.member(scene, "", "extensions", &Json::is_object, "an object"))
    if (const Json* ours =
            check.member(*extensions, "extensions.", kExtensionName, &Json::is_object, "an object"))
      check.list(*ours, "extensions." + std::string(kExtensionName) + ".", "assets", &Json::is_object,
                 "an object");
  return std::move(check.issues);
}

Result<GltfDocument> parseGltf(std::string_view bytes, const std::string& name) {
  GltfDocument document;
  std::string_view json = bytes;
  if (bytes.size() >= 12 && u32At(bytes, 0) == kGlbMagic) {
    document.binary = true;
    if (const Status status = splitGlb(bytes, name, json, document.binary_chunk); !status)
      return status.issue();
  }
  if (const Status depth = checkJsonDepth(json, name); !depth) return depth.issue();
  if (!parseInto(document.json, json) || !document.json.is_object())
    return issueAt(issue_id::kGltfParse, name, "is no glTF: not a JSON object");
  if (!versionOf(document.json).starts_with("2."))
    return issueAt(issue_id::kGltfVersion, name + ": asset.version", "is not 2.x");
  return document;
}

std::string serializeGltf(const GltfDocument& document) {
  constexpr auto kReplace = nlohmann::ordered_json::error_handler_t::replace;
  if (!document.binary) return document.json.dump(2, ' ', false, kReplace) + "\n";
  std::string json = document.json.dump(-1, ' ', false, kReplace), binary = document.binary_chunk;
  json.append((4 - json.size() % 4) % 4, ' ');
  binary.append((4 - binary.size() % 4) % 4, '\0');
  const size_t binary_size = binary.empty() ? 0 : 8 + binary.size();
  std::string bytes;
  appendU32(bytes, kGlbMagic);
  appendU32(bytes, 2);
  appendU32(bytes, static_cast<uint32_t>(12 + 8 + json.size() + binary_size));
  appendU32(bytes, static_cast<uint32_t>(json.size()));
  appendU32(bytes, kJsonChunk);
  bytes += json;
  if (binary_size) {
    appendU32(bytes, static_cast<uint32_t>(binary.size()));
    appendU32(bytes, kBinaryChunk);
    bytes += binary;
  }
  return bytes;
}

int64_t integerMember(const nlohmann::ordered_json& object, const char* key) {
  if (!object.is_object()) return -1;
  const auto member = object.find(key);
  if (member == object.end() || !member->is_number_integer()) return -1;
  if (member->is_number_unsigned() && member->get<uint64_t>() > INT64_MAX) return -1;
  return std::max<int64_t>(-1, member->get<int64_t>());
}

size_t arraySize(const nlohmann::ordered_json& object, const char* key) {
  if (!object.is_object()) return 0;
  const auto member = object.find(key);
  return member != object.end() && member->is_array() ? member->size() : 0;
}

std::vector<std::string> primitivesWithout(const nlohmann::ordered_json& scene, int64_t material,
                                           const std::string& attribute) {
  std::vector<std::string> places;
  for (size_t m = 0; m < arraySize(scene, "meshes"); ++m)
    for (size_t p = 0; p < arraySize(scene["meshes"][m], "primitives"); ++p) {
      const auto& primitive = scene["meshes"][m]["primitives"][p];
      if (integerMember(primitive, "material") != material) continue;
      if (!primitive.contains("attributes") || !primitive["attributes"].contains(attribute))
        places.push_back("meshes[" + std::to_string(m) + "].primitives[" + std::to_string(p) + "]");
    }
  return places;
}

std::string uriFromPath(const std::filesystem::path& relative) {
  constexpr const char* kHex = "0123456789ABCDEF";
  std::string uri;
  for (const char c : relative.generic_string()) {
    const auto u = static_cast<unsigned char>(c);
    const bool plain = std::isalnum(u) || std::strchr("-._~/", c);
    uri += plain ? std::string(1, c) : std::string{'%', kHex[u >> 4], kHex[u & 15]};
  }
  return uri;
}

bool isDataUri(std::string_view uri) {
  return uri.starts_with("data:");
}

std::string base64(std::string_view bytes) {
  constexpr const char* kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t group = 0;
    for (size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (size_t k = 0; k < 4; ++k)
      text += i + k <= bytes.size() ? kAlphabet[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

std::optional<std::string> bytesOfDataUri(std::string_view uri) {
  constexpr std::string_view kMark = ";base64,";
  const size_t comma = uri.find(',');
  if (!isDataUri(uri) || comma == std::string_view::npos || !uri.substr(0, comma + 1).ends_with(kMark))
    return std::nullopt;
  std::string_view text = uri.substr(comma + 1);
  for (int padding = 0; padding < 2 && text.ends_with('='); ++padding) text.remove_suffix(1);
  if (text.size() % 4 == 1) return std::nullopt;
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3 + 2);
  uint32_t group = 0;
  for (size_t i = 0; i < text.size(); ++i) {
    const int digit = base64Digit(text[i]);
    if (digit < 0) return std::nullopt;
    group = group << 6 | static_cast<uint32_t>(digit);
    if (i % 4 > 0) bytes += static_cast<char>(group >> (6 - 2 * (i % 4)) & 0xFF);
  }
  return bytes;
}

}  // namespace loden::importer
