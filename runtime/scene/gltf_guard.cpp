#include "runtime/scene/gltf_guard.h"

#include <cstring>
#include <fstream>

#include "material/base/issues.h"

namespace loden::runtime {
namespace {

namespace fs = std::filesystem;

uint32_t readU32(std::span<const std::byte> bytes, size_t at) {
  uint32_t value = 0;
  for (int i = 3; i >= 0; --i) value = value << 8 | std::to_integer<uint32_t>(bytes[at + i]);
  return value;
}

}  // namespace

Result<std::string_view> gltfJson(std::span<const std::byte> bytes, const std::string& name) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (!text.starts_with("glTF")) return text;
  constexpr uint32_t kJsonChunk = 0x4E4F534A;
  constexpr size_t kHeader = 20;  // file header and the first chunk's
  if (bytes.size() < kHeader || readU32(bytes, 16) != kJsonChunk ||
      readU32(bytes, 12) > bytes.size() - kHeader)
    return Issue{issue_id::kGltfParse, Severity::kError, name + ": header",
                 "the .glb header or its JSON chunk is damaged"};
  return text.substr(kHeader, readU32(bytes, 12));
}

Result<std::vector<std::byte>> readRegularFile(const fs::path& path) {
  const auto fail = [&](int id, const std::string& why) {
    return Issue{id, Severity::kError, path.string(), why};
  };
  std::error_code error;
  if (!fs::is_regular_file(path, error))
    return fail(issue_id::kCannotOpen, "no such file, or not a regular file");
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
