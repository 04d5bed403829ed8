#include "runtime/image_read.h"

#include <algorithm>
#include <memory>
#include <vector>

#include "material/asset.h"
#include "material/issues.h"

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_HDR
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS 16384
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-but-set-variable"
#pragma GCC diagnostic ignored "-Wsign-compare"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace loden::runtime {
namespace {

constexpr uint64_t kMaxBytes = uint64_t(1) << 29;  // 16384 x 8192 RGBE pixels
constexpr int kMaxWidth = 16384, kMaxHeight = 8192;

Issue issueOf(int id, const std::filesystem::path& path, const std::string& text) {
  return {id, Severity::kError, path.string(), text};
}

// Fewer bytes than this no picture of the extents has, flat or run-length encoded: a short file cannot ask for
// gigabytes.
uint64_t leastBytes(int width, int height) {
  const uint64_t w = static_cast<uint64_t>(width);
  return static_cast<uint64_t>(height) * std::min(4 * w, 4 + 8 * ((w + 126) / 127));
}

}  // namespace

Result<Panorama> readPanorama(const std::filesystem::path& path) {
  const auto source = openFileSource(path);
  if (!source) return source.issue();
  if ((*source)->size() > kMaxBytes) return issueOf(issue_id::kLimit, path, "larger than 512 MiB");
  std::vector<std::byte> bytes((*source)->size());
  if (Status status = (*source)->read(0, bytes); !status) return status.issue();
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int size = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  if (!stbi_info_from_memory(data, size, &width, &height, &channels))
    return issueOf(issue_id::kOption, path, "is no Radiance picture (.hdr)");
  if (width > kMaxWidth || height > kMaxHeight) return issueOf(issue_id::kLimit, path, "larger than 16384 x 8192 pixels");
  if (bytes.size() < leastBytes(width, height)) return issueOf(issue_id::kOption, path, "is damaged: it ends early");
  const std::unique_ptr<float, void (*)(void*)> pixels(stbi_loadf_from_memory(data, size, &width, &height, &channels, 3),
                                                       stbi_image_free);
  if (!pixels) return issueOf(issue_id::kOption, path, std::string("is damaged: ") + stbi_failure_reason());
  Panorama panorama{width, height, std::vector<glm::vec3>(size_t(width) * size_t(height))};
  for (size_t i = 0; i < panorama.pixels.size(); ++i)
    panorama.pixels[i] = {pixels.get()[3 * i], pixels.get()[3 * i + 1], pixels.get()[3 * i + 2]};
  return panorama;
}

}  // namespace loden::runtime
