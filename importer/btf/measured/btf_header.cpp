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

// Light lists of two views that differ by less, as unit vectors, are the same list written twice.
constexpr double kSameDirection = 1e-4;
constexpr uint32_t kLegacyMagic = 301074;  // in front of the legacy PVF layout, where others have a size

glm::vec2 readAngles(asset::ByteCursor& cursor) {
  const float theta = cursor.f32(), phi = cursor.f32();
  return {theta, phi};
}

glm::dvec3 directionOf(glm::vec2 angles) {
  return directionFromSpherical({std::max(0.0, double(angles.x)), angles.y});
}

Status checkDirection(const asset::ByteCursor& cursor, glm::vec2 angles, const std::string& name,
                      const std::string& where) {
  if (!cursor.ok()) return cutShort(name, "at the angles of " + where);
  if (std::isfinite(angles.x) && std::isfinite(angles.y) && angles.x >= -kSameDirection &&
      angles.x < float(kPi / 2))
    return {};
  return brokenFile(name, where + " has theta " + std::to_string(angles.x) + " and phi " +
                              std::to_string(angles.y) + " radians; theta must be 0 to below pi / 2");
}

Status checkCount(const asset::ByteCursor& cursor, uint32_t count, const std::string& name,
                  const std::string& what) {
  if (!cursor.ok()) return cutShort(name, "at the number of " + what);
  if (count >= 1 && count <= Limits::kMaxDirections) return {};
  return brokenFile(name, "says that there are " + std::to_string(count) + " " + what + "; 1 to " +
                              std::to_string(Limits::kMaxDirections) + " are possible");
}

// A set that is one of the known ones up to rounding becomes it, so that tables by rings can be made.
DirectionSet setOf(const std::vector<glm::vec2>& angles) {
  DirectionSet set;
  for (const glm::vec2& a : angles) set.samples.push_back(directionOf(a));
  for (const DirectionSet& known : {bonn81Directions(), ubo151Directions()}) {
    if (known.size() != set.size()) continue;
    bool same = true;
    for (int i = 0; i < set.size(); ++i)
      same &= glm::distance(known.samples[i], set.samples[i]) < kSameDirection;
    if (same) return known;
  }
  return set;
}

// Names are free text of the file: they are cut and stripped of what is no printable ASCII.
std::string printable(std::string text) {
  text.resize(std::min<size_t>(text.size(), 16));
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c > 0x7e; }, '?');
  return text;
}

Status readChannels(asset::ByteCursor& cursor, Header& header, const std::string& name) {
  header.channels = cursor.u32();
  if (!cursor.ok()) return cutShort(name, "at the number of channels");
  if (header.channels < 1 || header.channels > Limits::kMaxChannels)
    return brokenFile(name, "says that there are " + std::to_string(header.channels) + " channels; 1 to " +
                                std::to_string(Limits::kMaxChannels) + " are possible");
  std::string names;
  for (uint32_t c = 0; c < header.channels && cursor.ok(); ++c)
    names += (c ? ", " : "") + printable(cursor.text(cursor.u32()));
  if (!cursor.ok()) return cutShort(name, "in the names of its channels");
  if (header.channels == 1 || header.channels == 3) return {};
  return unsupported(name, "has " + std::to_string(header.channels) + " channels (" + names +
                               "), which are no colours red, green and blue; convert the spectra to RGB");
}

Status readMetadata(asset::ByteCursor& cursor, Header& header, const std::string& name) {
  const size_t begin = cursor.left();
  const uint32_t size = cursor.u32(), version = cursor.u32();
  cursor.bytes(3 * 80);       // set-up, sensor, light: free text
  cursor.bytes(4 * (1 + 3));  // pixels per millimetre, RGB scale: not reliable, not used
  if (version > 1) header.cosine = cursor.u32() == 1 ? CosineFlag::kIncluded : CosineFlag::kNotIncluded;
  if (version > 2) cursor.bytes(cursor.u32());  // XML
  if (!cursor.ok()) return cutShort(name, "in its metadata");
  if (version > 3)
    if (const Status status = readChannels(cursor, header, name); !status) return status;
  const size_t used = begin - cursor.left();
  if (size < used)
    return brokenFile(name, "its metadata says that it has " + std::to_string(size) + " bytes and has " +
                                std::to_string(used));
  if (size - used > cursor.left()) return cutShort(name, "in its metadata");
  cursor.bytes(size - used);
  return {};
}

// All views must have been lit from the same directions.
Status readLights(asset::ByteCursor& cursor, uint32_t view, std::vector<glm::vec2>& first_list,
                  const std::string& name) {
  const std::string of_view = " of view " + std::to_string(view);
  const uint32_t lights = cursor.u32();
  if (const Status status = checkCount(cursor, lights, name, "lights" + of_view); !status) return status;
  const auto differs = [&](const std::string& how) {
    return unsupported(name, "view " + std::to_string(view) + how +
                                 "; only one list of lights for all views is read: resample the file to one");
  };
  if (view > 0 && lights != first_list.size())
    return differs(" has " + std::to_string(lights) + " lights and view 0 has " +
                   std::to_string(first_list.size()));
  for (uint32_t l = 0; l < lights; ++l) {
    const glm::vec2 angles = readAngles(cursor);
    const std::string where = "light " + std::to_string(l) + of_view;
    if (const Status status = checkDirection(cursor, angles, name, where); !status) return status;
    if (view == 0)
      first_list.push_back(angles);
    else if (glm::distance(directionOf(angles), directionOf(first_list[l])) > kSameDirection)
      return differs(" has another light " + std::to_string(l) + " than view 0");
  }
  return {};
}

Status readSampling(asset::ByteCursor& cursor, Header& header, const std::string& name) {
  const uint32_t views = cursor.u32();
  if (const Status status = checkCount(cursor, views, name, "views"); !status) return status;
  std::vector<glm::vec2> view_angles, light_angles;
  for (uint32_t v = 0; v < views; ++v) {
    view_angles.push_back(readAngles(cursor));
    if (const Status status = checkDirection(cursor, view_angles.back(), name, "view " + std::to_string(v));
        !status)
      return status;
    if (const Status status = readLights(cursor, v, light_angles, name); !status) return status;
  }
  header.views = setOf(view_angles);
  header.lights = setOf(light_angles);
  return {};
}

Status readSize(asset::ByteCursor& cursor, Header& header, const std::string& name) {
  header.width = cursor.u32();
  header.height = cursor.u32();
  if (!cursor.ok()) return cutShort(name, "at width and height");
  if (header.width >= 1 && header.height >= 1 && header.width <= Limits::kMaxSide &&
      header.height <= Limits::kMaxSide)
    return {};
  return brokenFile(name, "says that its images have " + std::to_string(header.width) + " x " +
                              std::to_string(header.height) + " texels; a side must be 1 to " +
                              std::to_string(Limits::kMaxSide));
}

bool isLegacyPvf(asset::ByteCursor look, Kind kind) {
  return kind == Kind::kPvf && look.u32() == kLegacyMagic;
}

// Magic, components, width, height, number of factored views, sampling; three channels, no rotations.
Status readLegacyPvf(asset::ByteCursor& cursor, Header& header, const std::string& name) {
  header.legacy = true;
  cursor.u32();
  cursor.u32();  // each view says its own number of components
  if (const Status status = readSize(cursor, header, name); !status) return status;
  header.view_slots = cursor.u32();
  return readSampling(cursor, header, name);
}

}  // namespace

Issue brokenFile(const std::string& name, const std::string& text) {
  return {issue_id::kMeasured, Severity::kError, name, text + "; the file is damaged or no Bonn .btf"};
}

Issue cutShort(const std::string& name, const std::string& place) {
  return {issue_id::kMeasured, Severity::kError, name,
          "ends " + place + "; it is damaged or only a part of a file: fetch it again"};
}

Issue unsupported(const std::string& name, const std::string& text) {
  return {issue_id::kVersion, Severity::kError, name, text};
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
    return Issue{issue_id::kMeasured, Severity::kError, name,
                 "is no Bonn .btf file: it does not begin with !DFMF08FCR, !FMF12FCER, !FMF06FC, !PVF06FC or "
                 "!BDIF06R2!; other uses of the name .btf, such as zipped RTI images, are not read"};
  header.signature = *found;
  cursor.bytes(std::strlen(found->text));
  if (isLegacyPvf(cursor, found->kind)) {
    if (const Status status = readLegacyPvf(cursor, header, name); !status) return status.issue();
    return header;
  }
  for (const auto read : {readMetadata, readSampling, readSize})
    if (const Status status = read(cursor, header, name); !status) return status.issue();
  if (found->kind != Kind::kBdi)
    if (const Status status = skipRotations(cursor, header, name); !status) return status.issue();
  return header;
}

Status skipRotations(asset::ByteCursor& cursor, const Header& header, const std::string& name) {
  if (!header.signature.rotations) return {};
  const uint64_t bytes = uint64_t{cursor.u32()} * 9 * 4;
  if (!cursor.ok() || bytes > cursor.left()) return cutShort(name, "in its rotations");
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
                            const std::string& name, const std::string& where) {
  if (scalar_size != 2 && scalar_size != 4 && scalar_size != 8)
    return brokenFile(
        name, where + " has numbers of " + std::to_string(scalar_size) + " bytes; 2, 4 and 8 are possible");
  // Both counts are below 2^32 and the size is at most 8: only the last product can overflow, so divide
  // instead.
  if (!cursor.ok() || (rows > 0 && cols > cursor.left() / scalar_size / rows))
    return cutShort(name, "in " + where + ", which asks for " + std::to_string(rows) + " x " +
                              std::to_string(cols) + " numbers of " + std::to_string(scalar_size) + " bytes");
  return Numbers(cursor.bytes(rows * cols * scalar_size), scalar_size);
}

}  // namespace loden::importer::btf
