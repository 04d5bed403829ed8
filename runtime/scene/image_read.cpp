// Radiance pictures (Ward 1991), read here because the packaged stb_image never returns from a scanline cut
// short.
#include "runtime/scene/image_read.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string_view>
#include <vector>

#include "material/asset/asset.h"
#include "material/base/issues.h"
#include "material/system/asset_io.h"

namespace loden::runtime {
namespace {

constexpr uint64_t kMaxBytes = uint64_t(1) << 29;  // 16384 x 8192 RGBE pixels
constexpr int kMaxWidth = 16384, kMaxHeight = 8192;

Issue issueOf(int id, const std::filesystem::path& path, const std::string& text) {
  return {id, Severity::kError, path.string(), text};
}

// Fewer bytes than this no picture of the extents has, flat or run-length encoded: a short file cannot ask
// for gigabytes.
uint64_t leastBytes(int width, int height) {
  const uint64_t w = static_cast<uint64_t>(width);
  return static_cast<uint64_t>(height) * std::min(4 * w, 4 + 8 * ((w + 126) / 127));
}

// Takes the text up to the next line end; false at the end of the bytes.
bool takeLine(std::string_view& bytes, std::string_view& line) {
  const size_t end = bytes.find('\n');
  if (end == std::string_view::npos) return false;
  line = bytes.substr(0, end);
  bytes.remove_prefix(end + 1);
  return true;
}

// Header lines up to the resolution; true if both are as a panorama has them.
bool takeHeader(std::string_view& bytes, int& width, int& height) {
  std::string_view line;
  if (!takeLine(bytes, line) || (line != "#?RADIANCE" && line != "#?RGBE")) return false;
  bool rgbe = false;
  while (takeLine(bytes, line) && !line.empty()) rgbe = rgbe || line == "FORMAT=32-bit_rle_rgbe";
  if (!rgbe || !takeLine(bytes, line) || line.size() > 60) return false;
  return std::sscanf(std::string(line).c_str(), "-Y %d +X %d", &height, &width) == 2 && width > 0 &&
         height > 0;
}

// One of the four channels of a scanline in runs; false where the bytes end or a run leaves the line.
bool takeRuns(std::string_view& bytes, int width, int channel, std::vector<unsigned char>& line) {
  for (int x = 0; x < width;) {
    if (bytes.size() < 2) return false;
    const int code = static_cast<unsigned char>(bytes[0]);
    const bool repeat = code > 128;
    const int count = repeat ? code - 128 : code;
    if (count < 1 || count > width - x || bytes.size() < size_t(repeat ? 2 : 1 + count)) return false;
    for (int k = 0; k < count; ++k, ++x)
      line[size_t(4 * x + channel)] = static_cast<unsigned char>(bytes[size_t(repeat ? 1 : 1 + k)]);
    bytes.remove_prefix(size_t(repeat ? 2 : 1 + count));
  }
  return true;
}

// A scanline of `width` RGBE pixels, run-length encoded or flat.
bool takeLineOfPixels(std::string_view& bytes, int width, std::vector<unsigned char>& line) {
  const auto at = [&](size_t i) { return static_cast<unsigned char>(bytes[i]); };
  const bool runs = width >= 8 && width < 32768 && bytes.size() >= 4 && at(0) == 2 && at(1) == 2 &&
                    at(2) * 256 + at(3) == width;
  if (runs) {
    bytes.remove_prefix(4);
    for (int channel = 0; channel < 4; ++channel)
      if (!takeRuns(bytes, width, channel, line)) return false;
    return true;
  }
  if (bytes.size() < line.size()) return false;
  std::copy_n(bytes.begin(), line.size(), line.begin());
  bytes.remove_prefix(line.size());
  return true;
}

}  // namespace

Result<Panorama> readPanorama(const std::filesystem::path& path) {
  const auto source = openFileSource(path);
  if (!source) return source.issue();
  if ((*source)->size() > kMaxBytes) return issueOf(issue_id::kLimit, path, "larger than 512 MiB");
  std::vector<std::byte> file((*source)->size());
  if (Status status = (*source)->read(0, file); !status) return status.issue();
  std::string_view bytes(reinterpret_cast<const char*>(file.data()), file.size());
  int width = 0, height = 0;
  if (!takeHeader(bytes, width, height))
    return issueOf(issue_id::kImage, path, "is no Radiance picture (.hdr) with its first line at the top");
  if (width > kMaxWidth || height > kMaxHeight)
    return issueOf(issue_id::kLimit, path, "larger than 16384 x 8192 pixels");
  if (bytes.size() < leastBytes(width, height))
    return issueOf(issue_id::kImage, path, "is damaged: it ends early");
  Panorama panorama{width, height, {}};
  panorama.pixels.reserve(size_t(width) * size_t(height));
  std::vector<unsigned char> line(4 * size_t(width));
  for (int y = 0; y < height; ++y) {
    if (!takeLineOfPixels(bytes, width, line))
      return issueOf(issue_id::kImage, path, "is damaged in line " + std::to_string(y));
    for (size_t x = 0; x < line.size(); x += 4) {
      const float scale = line[x + 3] ? std::ldexp(1.0f, line[x + 3] - 136) : 0.0f;
      panorama.pixels.push_back(glm::vec3(line[x], line[x + 1], line[x + 2]) * scale);
    }
  }
  return panorama;
}

}  // namespace loden::runtime
