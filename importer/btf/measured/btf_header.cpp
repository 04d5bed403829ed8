#include "importer/btf/measured/btf_header.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "material/base/issues.h"
#include "material/model/texture.h"

namespace loden::importer::btf {
namespace {

// The longest match wins, so longer texts stand first.
constexpr Signature kSignatures[] = {
    {"!DFMF08FCR", Kind::kDfmf, true, false}, {"!FMF12FCER", Kind::kFmf, true, true},
    {"!FMF06FCR", Kind::kFmf, true, false},   {"!PVF06FCR", Kind::kPvf, true, false},
    {"!BDIF06R2!", Kind::kBdi, true, false},  {"!FMF06FC", Kind::kFmf, false, false},
    {"!PVF06FC", Kind::kPvf, false, false}};

glm::vec2 readAngles(asset::ByteCursor& cursor) {
  const float theta = cursor.f32(), phi = cursor.f32();
  return {theta, phi};
}

bool isDirection(glm::vec2 angles) {
  return std::isfinite(angles.x) && std::isfinite(angles.y) && angles.x >= -1e-4f &&
         angles.x < float(kPi / 2);
}

// A set that is one of the known ones up to rounding becomes it, so that tables by rings can be made.
DirectionSet setOf(const std::vector<glm::vec2>& angles) {
  DirectionSet set;
  for (const glm::vec2& a : angles)
    set.samples.push_back(directionFromSpherical({std::max(0.0, double(a.x)), a.y}));
  for (const DirectionSet& known : {bonn81Directions(), ubo151Directions()}) {
    if (known.size() != set.size()) continue;
    bool same = true;
    for (int i = 0; i < set.size(); ++i) same &= glm::distance(known.samples[i], set.samples[i]) < 1e-4;
    if (same) return known;
  }
  return set;
}

Status readMetadata(asset::ByteCursor& cursor, Header& header, const std::string& name) {
  const size_t begin = cursor.left();
  const uint32_t size = cursor.u32(), version = cursor.u32();
  cursor.bytes(3 * 80);       // set-up, sensor, light: free text
  cursor.bytes(4 * (1 + 3));  // pixels per millimetre, RGB scale: not reliable, not used
  if (version > 1) header.cosine = cursor.u32() == 1 ? CosineFlag::kIncluded : CosineFlag::kNotIncluded;
  if (version > 2) cursor.bytes(cursor.u32());
  if (version > 3) {
    header.channels = cursor.u32();
    if (header.channels < 1 || header.channels > Limits::kMaxChannels)
      return brokenFile(name, "metadata: channel count is out of range");
    for (uint32_t c = 0; c < header.channels && cursor.ok(); ++c) cursor.bytes(cursor.u32());
  }
  const size_t used = begin - cursor.left();
  if (!cursor.ok() || size < used || size - used > cursor.left())
    return brokenFile(name, "metadata: its size does not fit the file");
  cursor.bytes(size - used);
  return {};
}

Status readSampling(asset::ByteCursor& cursor, Header& header, const std::string& name) {
  const uint32_t views = cursor.u32();
  if (views < 1 || views > Limits::kMaxDirections)
    return brokenFile(name, "sampling: view count is out of range");
  std::vector<glm::vec2> view_angles, light_angles;
  for (uint32_t v = 0; v < views; ++v) {
    view_angles.push_back(readAngles(cursor));
    const uint32_t lights = cursor.u32();
    if (!cursor.ok() || lights < 1 || lights > Limits::kMaxDirections || !isDirection(view_angles.back()))
      return brokenFile(name, "sampling: view " + std::to_string(v) + " is broken");
    if (v > 0 && lights != light_angles.size())
      return brokenFile(name,
                        "sampling: view " + std::to_string(v) + " has another number of lights than view 0");
    for (uint32_t l = 0; l < lights; ++l) {
      const glm::vec2 angles = readAngles(cursor);
      if (!cursor.ok() || !isDirection(angles))
        return brokenFile(
            name, "sampling: light " + std::to_string(l) + " of view " + std::to_string(v) + " is broken");
      if (v == 0)
        light_angles.push_back(angles);
      else if (angles != light_angles[l])
        return brokenFile(name, "sampling: view " + std::to_string(v) + " has other lights than view 0");
    }
  }
  header.views = setOf(view_angles);
  header.lights = setOf(light_angles);
  return {};
}

}  // namespace

Issue brokenFile(const std::string& name, const std::string& text) {
  return {issue_id::kMeasured, Severity::kError, name, text};
}

uint8_t readU8(asset::ByteCursor& cursor) {
  const auto byte = cursor.bytes(1);
  return byte.empty() ? 0 : static_cast<uint8_t>(byte[0]);
}

Result<Header> readHeader(asset::ByteCursor& cursor, const std::string& name) {
  Header header;
  asset::ByteCursor look = cursor;
  const std::string front = look.text(std::min<size_t>(10, look.left()));
  const auto* found = std::find_if(std::begin(kSignatures), std::end(kSignatures),
                                   [&](const Signature& s) { return front.starts_with(s.text); });
  if (found == std::end(kSignatures))
    return brokenFile(name,
                      "is no Bonn .btf file: it does not begin with !DFMF08FCR, !FMF12FCER, !FMF06FC, "
                      "!PVF06FC or !BDIF06R2!");
  header.signature = *found;
  cursor.bytes(std::strlen(found->text));
  if (const Status status = readMetadata(cursor, header, name); !status) return status.issue();
  if (const Status status = readSampling(cursor, header, name); !status) return status.issue();
  header.width = cursor.u32();
  header.height = cursor.u32();
  if (!cursor.ok() || header.width < 1 || header.height < 1 || header.width > Limits::kMaxSide ||
      header.height > Limits::kMaxSide)
    return brokenFile(name, "width or height is out of range");
  return header;
}

Status skipRotations(asset::ByteCursor& cursor, const Header& header, const std::string& name) {
  if (!header.signature.rotations) return {};
  const uint64_t bytes = uint64_t{cursor.u32()} * 9 * 4;
  if (!cursor.ok() || bytes > cursor.left()) return brokenFile(name, "rotations: more than the file holds");
  cursor.bytes(bytes);
  return {};
}

double Numbers::operator[](size_t i) const {
  const std::byte* at = bytes_.data() + i * scalar_size_;
  if (scalar_size_ == 2) {
    uint16_t half = 0;
    std::memcpy(&half, at, 2);
    return floatFromHalf(half);
  }
  if (scalar_size_ == 4) {
    float value = 0;
    std::memcpy(&value, at, 4);
    return value;
  }
  double value = 0;
  std::memcpy(&value, at, 8);
  return value;
}

Result<Numbers> readNumbers(asset::ByteCursor& cursor, uint64_t rows, uint64_t cols, uint8_t scalar_size,
                            const std::string& name) {
  if (scalar_size != 2 && scalar_size != 4 && scalar_size != 8)
    return brokenFile(name, "scalar size is none of 2, 4, 8");
  // Both counts are below 2^32 and the size is at most 8: only the last product can overflow, so divide
  // instead.
  if (!cursor.ok() || (rows > 0 && cols > cursor.left() / scalar_size / rows))
    return brokenFile(name, "a matrix is larger than the file");
  return Numbers(cursor.bytes(rows * cols * scalar_size), scalar_size);
}

}  // namespace loden::importer::btf
