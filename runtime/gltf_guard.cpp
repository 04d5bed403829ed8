#include "runtime/gltf_guard.h"

#include <cstring>
#include <fstream>
#include <optional>

#include "material/issues.h"

namespace loden::runtime {
namespace {

namespace fs = std::filesystem;

uint32_t readU32(std::span<const std::byte> bytes, size_t at) {
  uint32_t value = 0;
  for (int i = 3; i >= 0; --i) value = value << 8 | std::to_integer<uint32_t>(bytes[at + i]);
  return value;
}

int hexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

// Percent-decoded; nothing if an escape is broken or hides a zero byte.
std::optional<std::string> decodeUri(std::string_view uri) {
  std::string text;
  for (size_t i = 0; i < uri.size(); ++i) {
    char c = uri[i];
    if (c == '%') {
      if (uri.size() - i < 3) return {};
      const int high = hexDigit(uri[i + 1]), low = hexDigit(uri[i + 2]);
      if (high < 0 || low < 0) return {};
      c = static_cast<char>(high * 16 + low);
      i += 2;
    }
    if (c == '\0') return {};
    text += c;
  }
  return text;
}

bool isInside(const fs::path& folder, const fs::path& path) {
  const fs::path relative = path.lexically_relative(folder);
  return !relative.empty() && *relative.begin() != ".." && relative != ".";
}

}  // namespace

Result<std::string_view> gltfJson(std::span<const std::byte> bytes, const std::string& name) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (!text.starts_with("glTF")) return text;
  constexpr uint32_t kJsonChunk = 0x4E4F534A;
  constexpr size_t kHeader = 20;  // file header and the first chunk's
  if (bytes.size() < kHeader || readU32(bytes, 16) != kJsonChunk || readU32(bytes, 12) > bytes.size() - kHeader)
    return Issue{issue_id::kGltfParse, Severity::kError, name + ": header", "the .glb header or its JSON chunk is damaged"};
  return text.substr(kHeader, readU32(bytes, 12));
}

Result<fs::path> confinedPath(const fs::path& folder, std::string_view uri) {
  const auto refuse = [&](const char* why) {
    return Issue{issue_id::kGltfPath, Severity::kError, "uri \"" + std::string(uri.substr(0, 200)) + "\"", why};
  };
  const std::optional<std::string> text = decodeUri(uri);
  if (!text || text->empty()) return refuse("not a valid relative URI");
  if (text->find("://") != std::string::npos || fs::path(*text).is_absolute())
    return refuse("only files beside the glTF are read: make the URI relative");
  std::error_code error;
  const fs::path base = fs::weakly_canonical(folder.empty() ? fs::path(".") : folder, error);
  if (error) return refuse("the asset's folder cannot be resolved");
  const fs::path path = fs::weakly_canonical(base / *text, error);
  if (error || !isInside(base, path)) return refuse("leads outside the glTF's folder: move the file into it");
  return path;
}

Result<std::vector<std::byte>> readRegularFile(const fs::path& path) {
  const auto fail = [&](int id, const std::string& why) {
    return Issue{id, Severity::kError, path.string(), why};
  };
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return fail(issue_id::kCannotOpen, "no such file, or not a regular file");
  const uint64_t size = fs::file_size(path, error);
  if (error) return fail(issue_id::kCannotOpen, error.message());
  if (size > kMaxGltfBytes) return fail(issue_id::kCannotRead, "larger than 1 GiB");
  std::ifstream in(path, std::ios::binary);
  if (!in) return fail(issue_id::kCannotOpen, "cannot be opened for reading");
  std::vector<std::byte> bytes(size);
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (static_cast<uint64_t>(in.gcount()) != size) return fail(issue_id::kCannotRead, "ended early");
  return bytes;
}

}  // namespace loden::runtime
