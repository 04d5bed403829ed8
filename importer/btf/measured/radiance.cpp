// Radiance RGBE pictures, flat and run-length encoded (Ward, "Real Pixels", and the Radiance file formats).
#include <cmath>
#include <string>

#include "importer/base/file_read.h"
#include "importer/btf/measured/bonn_folder.h"
#include "material/base/issues.h"

namespace loden::importer {
namespace {

constexpr int kMaxSide = 16384;

Issue radianceIssue(const std::filesystem::path& path, const std::string& text) {
  return {issue_id::kImage, Severity::kError, path.string(), text};
}

glm::vec4 fromRgbe(const unsigned char* rgbe) {
  if (rgbe[3] == 0) return {0, 0, 0, 1};
  const float scale = std::ldexp(1.0f, rgbe[3] - (128 + 8));
  return {(rgbe[0] + 0.5f) * scale, (rgbe[1] + 0.5f) * scale, (rgbe[2] + 0.5f) * scale, 1};
}

// One scanline into rgbe (4 * width); false if the bytes end or a run leaves the line.
bool readScanline(const std::string& bytes, size_t& at, int width, std::vector<unsigned char>& rgbe) {
  const auto left = [&] { return bytes.size() - at; };
  const auto byte = [&](size_t offset) { return static_cast<unsigned char>(bytes[at + offset]); };
  if (left() < 4) return false;
  const bool encoded =
      width >= 8 && width < 32768 && byte(0) == 2 && byte(1) == 2 && (byte(2) << 8 | byte(3)) == width;
  if (!encoded) {
    if (left() < size_t(width) * 4) return false;
    for (int i = 0; i < width * 4; ++i) rgbe[i] = byte(i);
    at += size_t(width) * 4;
    return true;
  }
  at += 4;
  for (int channel = 0; channel < 4; ++channel)
    for (int x = 0; x < width;) {
      if (left() < 2) return false;
      const int code = byte(0), run = code > 128 ? code - 128 : code;
      const bool repeated = code > 128;
      if (run == 0 || run > width - x || left() < size_t(repeated ? 2 : 1 + run)) return false;
      for (int k = 0; k < run; ++k) rgbe[4 * (x + k) + channel] = byte(repeated ? 1 : 1 + k);
      at += repeated ? 2 : 1 + run;
      x += run;
    }
  return true;
}

}  // namespace

Result<Picture> readRadiance(const std::filesystem::path& path) {
  const auto file = readFile(path);
  if (!file) return file.issue();
  const std::string& bytes = *file;
  const size_t header_end = bytes.find("\n\n");
  if (!bytes.starts_with("#?") || header_end == std::string::npos)
    return radianceIssue(path, "is no Radiance picture");
  const size_t line_end = bytes.find('\n', header_end + 2);
  if (line_end == std::string::npos) return radianceIssue(path, "has no resolution line");
  const std::string resolution = bytes.substr(header_end + 2, line_end - header_end - 2);
  int width = 0, height = 0;
  const bool usual = std::sscanf(resolution.c_str(), "-Y %d +X %d", &height, &width) == 2;
  const bool atrium = !usual && std::sscanf(resolution.c_str(), "+X %d -Y %d", &width, &height) == 2;
  if (!usual && !atrium)
    return radianceIssue(path, "has the pixel order '" + resolution + "', which is not supported");
  if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide)
    return radianceIssue(path, "sides must be 1 to 16384");

  size_t at = line_end + 1;
  std::vector<unsigned char> rgbe(size_t(width) * 4);
  Picture picture{width, height, std::vector<glm::vec4>(size_t(width) * height)};
  for (int row = 0; row < height; ++row) {
    if (!readScanline(bytes, at, width, rgbe))
      return radianceIssue(path, "ends or breaks in row " + std::to_string(row));
    const int y = atrium ? height - 1 - row : row;
    for (int x = 0; x < width; ++x) picture.at(x, y) = fromRgbe(&rgbe[size_t(x) * 4]);
  }
  return picture;
}

}  // namespace loden::importer
