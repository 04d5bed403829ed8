#include "runtime/scene/gltf_rewrite.h"

#include <nlohmann/json.hpp>
#include <string>

namespace loden::runtime {
namespace {

using Json = nlohmann::json;

constexpr const char* kMeshopt = "EXT_meshopt_compression";

// An object's member, or null if there is none.
const Json& member(const Json& object, const char* key) {
  static const Json kNull;
  return object.is_object() && object.contains(key) ? object[key] : kNull;
}

// True for a buffer that only stands for what is decompressed.
bool isFallback(const Json& buffer) {
  return member(buffer, "uri").is_null() &&
         member(member(member(buffer, "extensions"), kMeshopt), "fallback") == true;
}

bool rewriteBuffers(Json& document) {
  bool changed = false;
  if (!member(document, "buffers").is_array()) return changed;
  for (Json& buffer : document["buffers"])
    if (isFallback(buffer)) {
      buffer = {{"uri", "data:application/octet-stream;base64,AAAA"}, {"byteLength", 3}};
      changed = true;
    }
  return changed;
}

void appendU32(std::vector<std::byte>& bytes, size_t value) {
  for (int shift = 0; shift < 32; shift += 8) bytes.push_back(std::byte(value >> shift & 255));
}
void append(std::vector<std::byte>& bytes, std::span<const std::byte> more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

// The binary file with another JSON chunk.
std::vector<std::byte> binaryWith(std::span<const std::byte> file, std::string json, size_t old_size) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const auto rest = file.subspan(20 + old_size);  // file header, chunk header
  std::vector<std::byte> bytes(file.begin(), file.begin() + 8);
  appendU32(bytes, 20 + json.size() + rest.size());
  appendU32(bytes, json.size());
  append(bytes, file.subspan(16, 4));
  append(bytes, std::as_bytes(std::span(json)));
  append(bytes, rest);
  return bytes;
}

}  // namespace

std::vector<std::byte> withoutFallbackBuffers(std::span<const std::byte> file, std::string_view json) {
  if (json.find(kMeshopt) == json.npos) return {};
  Json document = Json::parse(json, nullptr, false);
  if (!rewriteBuffers(document)) return {};
  std::string text = document.dump(-1, ' ', false, Json::error_handler_t::replace);
  if (json.size() != file.size()) return binaryWith(file, std::move(text), json.size());
  std::vector<std::byte> bytes;
  append(bytes, std::as_bytes(std::span(text)));
  return bytes;
}

}  // namespace loden::runtime
