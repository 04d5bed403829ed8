#include "material/asset/asset_header.h"

#include "material/asset/asset_format.h"
#include "material/base/byte_cursor.h"

namespace loden::asset {
namespace {

using Limits = AssetLimits;

// --- writing, in the order of FORMAT.md section "HEAD" ---

void writeDirections(ByteWriter& out, const DirectionSet& set) {
  out.u32(static_cast<uint32_t>(set.kind));
  out.u32(static_cast<uint32_t>(set.side));
  out.u32(static_cast<uint32_t>(set.samples.size()));
  for (const glm::dvec3& sample : set.samples) {
    for (int axis = 0; axis < 3; ++axis) out.f64(sample[axis]);
  }
}

void writeVec4(ByteWriter& out, const glm::vec4& value) {
  for (int c = 0; c < 4; ++c) out.f32(value[c]);
}

void writeBand(ByteWriter& out, const Band& band) {
  out.u32(static_cast<uint32_t>(band.domain));
  out.u32(static_cast<uint32_t>(band.filter));
  out.u32(static_cast<uint32_t>(band.layout));
  for (const float edge : {band.window.in_begin, band.window.in_end, band.window.out_begin,
                           band.window.out_end, band.lambda_first}) {
    out.f32(edge);
  }
  out.u32(static_cast<uint32_t>(band.y_quads));
  out.u32(static_cast<uint32_t>(band.chroma_quads));
  out.u32(band.ratio ? 1 : 0);
  out.u32(static_cast<uint32_t>(band.lead_quads));
  const Texture &weights = band.weights, &table = band.table;
  out.u32(static_cast<uint32_t>(weights.format));
  for (const int extent : {weights.width, weights.height, weights.depth, weights.mips}) out.u32(extent);
  out.u32(static_cast<uint32_t>(table.format));
  for (const int extent : {table.width, table.height, table.depth}) out.u32(extent);
  writeVec4(out, band.ratio_scale);
  for (const glm::vec4& scale : band.quad_scale) writeVec4(out, scale);
  for (const QuadLevels& levels : band.quad_levels) out.f32(levels.begin), out.f32(levels.end);
}

void writeMean(ByteWriter& out, const PhongMean& mean) {
  for (const float value : {mean.ka, mean.kd, mean.ks, mean.alpha, mean.cb, mean.cr}) out.f32(value);
  out.u32(static_cast<uint32_t>(mean.chroma));
}

void writeMaps(ByteWriter& out, const Material& material) {
  if (const GeometryImage& geometry = material.geometry; geometry.texels.width > 0) {
    out.u32(static_cast<uint32_t>(geometry.side()));
    for (int axis = 0; axis < 3; ++axis) out.f32(geometry.range[axis]);
    out.u32(geometry.identity_parameterization ? 1 : 0);
    for (const int count : {material.atlas.texels, material.atlas.directions})
      out.u32(static_cast<uint32_t>(count));
  }
  if (material.stored_vdim) {
    const PaperVdim& vdim = *material.stored_vdim;
    for (const int count : {vdim.side, vdim.zeniths, vdim.azimuths}) out.u32(count);
    for (int axis = 0; axis < 2; ++axis) out.f32(vdim.range[axis]);
  }
  if (!material.surface) return;
  const SurfaceMaps& maps = *material.surface;
  out.u32(static_cast<uint32_t>(maps.lobe));
  out.u32(static_cast<uint32_t>(maps.visibility));
  for (const float value :
       {maps.specular_scale, maps.lambda_first, maps.ambient_first, maps.fade_begin, maps.fade_end})
    out.f32(value);
  out.u32(static_cast<uint32_t>(maps.tail_mip));
  for (const SurfaceMapRow& row : kSurfaceMapRows) {
    const Texture& map = maps.*row.texture;
    const bool there = map.width > 0;
    for (const int extent : {map.width, map.height, map.depth, map.mips}) out.u32(there ? extent : 0);
  }
}

uint32_t partBits(const Material& material) {
  uint32_t bits = 0;
  if (material.geometry.texels.width > 0) bits |= kPartGeometry;
  if (material.stored_vdim) bits |= kPartStoredVdim;
  if (material.surface) bits |= kPartSurface;
  return bits;
}

// --- reading, in the same order ---

class HeaderReader {
 public:
  HeaderReader(std::span<const std::byte> record, IssueList& issues) : in_(record), issues_(issues) {}

  Material read() {
    Material material;
    material.mode = static_cast<Mode>(in_.u32());
    material.side = integer();
    material.lambda_min = in_.f32();
    material.lambda_max = in_.f32();
    material.value_scale = in_.f32();
    material.cosine_included = boolean("cosine_included");
    material.theta_max = in_.f32();
    material.aspect = in_.f32();
    material.period = in_.f32();
    material.mean = readMean();
    const uint32_t parts = readPartBits();
    material.lights = readDirections("lights");
    material.views = readDirections("views");
    readBands(material);
    readMaps(material, parts);
    material.name = in_.text(count(Limits::kMaxNameBytes, 1, "name_bytes", issue_id::kNameBytes));
    if (!failed_) {
      issues_.require(in_.ok(), issue_id::kHeadTruncated, "HEAD", "the record ends early");
      issues_.require(in_.left() == 0, issue_id::kHeadTrailing, "HEAD", in_.left(),
                      " bytes stand behind the record");
    }
    return material;
  }

 private:
  void fail(int id, const std::string& text) {
    issues_.add(id, "HEAD", text);
    failed_ = true;
    in_.bytes(in_.left());
  }

  // A number that checkMaterial checks; one beyond the range of int comes out negative, and fails there.
  int integer() { return static_cast<int>(in_.u32()); }

  bool boolean(const char* field) {
    const uint32_t value = in_.u32();
    if (value > 1) fail(issue_id::kBoolean, join(field, " is ", value, ", not 0 or 1"));
    return value == 1;
  }

  // How many items of at least `item_bytes` follow; 0 after a failure. `id`: the issue of more than `limit`.
  uint32_t count(uint32_t limit, size_t item_bytes, const char* field, int id) {
    const uint32_t value = in_.u32();
    if (failed_) return 0;
    if (value > limit) {
      fail(id, join(field, " is ", value, "; the limit is ", limit));
      return 0;
    }
    if (value > in_.left() / item_bytes) {
      fail(issue_id::kHeadCount, join(field, " is ", value, ", more than the record holds"));
      return 0;
    }
    return value;
  }

  PhongMean readMean() {
    PhongMean mean;
    for (float* value : {&mean.ka, &mean.kd, &mean.ks, &mean.alpha, &mean.cb, &mean.cr}) *value = in_.f32();
    mean.chroma = static_cast<MeanChroma>(in_.u32());
    return mean;
  }

  uint32_t readPartBits() {
    const uint32_t bits = in_.u32();
    constexpr uint32_t kKnown = kPartGeometry | kPartStoredVdim | kPartSurface;
    if ((bits & ~kKnown) != 0) fail(issue_id::kParts, join("parts has unknown bits: ", bits));
    return bits;
  }

  DirectionSet readDirections(const char* field) {
    DirectionSet set;
    set.kind = static_cast<DirectionSetKind>(in_.u32());
    set.side = integer();
    set.samples.resize(count(Limits::kMaxDirections, 3 * sizeof(double), field, issue_id::kDirectionCount));
    for (glm::dvec3& sample : set.samples) {
      for (int axis = 0; axis < 3; ++axis) sample[axis] = in_.f64();
    }
    return set;
  }

  glm::vec4 readVec4() {
    glm::vec4 value;
    for (int c = 0; c < 4; ++c) value[c] = in_.f32();
    return value;
  }

  Texture readTexture(TextureShape shape) {
    Texture texture;
    texture.format = static_cast<TexelFormat>(in_.u32());
    texture.shape = shape;
    texture.width = integer();
    texture.height = integer();
    texture.depth = integer();
    texture.mips = shape == TextureShape::kVolume ? 1 : integer();
    return texture;
  }

  Band readBand() {
    Band band;
    band.domain = static_cast<Domain>(in_.u32());
    band.filter = static_cast<WeightFilter>(in_.u32());
    band.layout = static_cast<TableLayout>(in_.u32());
    Window& window = band.window;
    for (float* edge : {&window.in_begin, &window.in_end, &window.out_begin, &window.out_end})
      *edge = in_.f32();
    band.lambda_first = in_.f32();
    const uint32_t y_quads = count(Limits::kMaxQuads, sizeof(glm::vec4), "y_quads", issue_id::kQuadCount);
    const uint32_t chroma_quads =
        count(Limits::kMaxQuads, sizeof(glm::vec4), "chroma_quads", issue_id::kQuadCount);
    band.y_quads = static_cast<int>(y_quads);
    band.chroma_quads = static_cast<int>(chroma_quads);
    band.ratio = boolean("ratio");
    band.lead_quads = integer();
    band.weights = readTexture(TextureShape::kArray2D);
    band.table = readTexture(TextureShape::kVolume);
    band.ratio_scale = readVec4();
    band.quad_scale.resize(y_quads + chroma_quads);
    for (glm::vec4& scale : band.quad_scale) scale = readVec4();
    band.quad_levels.resize(y_quads + chroma_quads);
    for (QuadLevels& levels : band.quad_levels) levels.begin = in_.f32(), levels.end = in_.f32();
    return band;
  }

  // The record has the coarsest first, the material the finest.
  void readBands(Material& material) {
    constexpr size_t kLeastBandBytes = 100;
    material.bands.resize(count(Limits::kMaxBands, kLeastBandBytes, "bands", issue_id::kBandCount));
    for (auto band = material.bands.rbegin(); band != material.bands.rend(); ++band) *band = readBand();
  }

  void readMaps(Material& material, uint32_t parts) {
    if ((parts & kPartGeometry) != 0) {
      material.geometry = readGeometry();
      material.geometry.aspect = material.aspect;
      material.atlas.texels = integer();
      material.atlas.directions = integer();
    }
    if ((parts & kPartStoredVdim) != 0) material.stored_vdim = readVdim();
    if ((parts & kPartSurface) != 0) material.surface = readSurface();
  }

  GeometryImage readGeometry() {
    GeometryImage geometry;
    const int side = integer();
    geometry.texels = {TexelFormat::kRGBA16Unorm, TextureShape::kArray2D, side, side, 1, 1, {}};
    for (int axis = 0; axis < 3; ++axis) geometry.range[axis] = in_.f32();
    geometry.identity_parameterization = boolean("identity");
    return geometry;
  }

  PaperVdim readVdim() {
    PaperVdim vdim;
    // Unsigned products: no overflow that the language forbids; checkMaterial checks the factors.
    const uint32_t side = in_.u32(), zeniths = in_.u32(), azimuths = in_.u32();
    vdim.side = static_cast<int>(side);
    vdim.zeniths = static_cast<int>(zeniths);
    vdim.azimuths = static_cast<int>(azimuths);
    vdim.reference = {TexelFormat::kRG16Snorm, TextureShape::kArray2D, vdim.side, vdim.side, 1, 1, {}};
    vdim.packed = {TexelFormat::kRGBA16Snorm,
                   TextureShape::kArray2D,
                   static_cast<int>(side * azimuths),
                   static_cast<int>(side * zeniths),
                   1,
                   1,
                   {}};
    for (int axis = 0; axis < 2; ++axis) vdim.range[axis] = in_.f32();
    return vdim;
  }

  SurfaceMaps readSurface() {
    SurfaceMaps maps;
    maps.lobe = static_cast<Lobe>(in_.u32());
    maps.visibility = static_cast<Visibility>(in_.u32());
    for (float* value :
         {&maps.specular_scale, &maps.lambda_first, &maps.ambient_first, &maps.fade_begin, &maps.fade_end})
      *value = in_.f32();
    maps.tail_mip = integer();
    for (const SurfaceMapRow& row : kSurfaceMapRows) {
      Texture map;
      map.format = row.format;
      for (int* extent : {&map.width, &map.height, &map.depth, &map.mips}) *extent = integer();
      const bool absent = map.width == 0 && map.height == 0 && map.depth == 0 && map.mips == 0;
      if (!absent) maps.*row.texture = map;
    }
    return maps;
  }

  ByteCursor in_;
  IssueList& issues_;
  bool failed_ = false;
};

}  // namespace

std::vector<std::byte> encodeHeader(const Material& material) {
  ByteWriter out;
  out.u32(static_cast<uint32_t>(material.mode));
  out.u32(static_cast<uint32_t>(material.side));
  for (const float value : {material.lambda_min, material.lambda_max, material.value_scale}) out.f32(value);
  out.u32(material.cosine_included ? 1 : 0);
  out.f32(material.theta_max);
  out.f32(material.aspect);
  out.f32(material.period);
  writeMean(out, material.mean);
  out.u32(partBits(material));
  writeDirections(out, material.lights);
  writeDirections(out, material.views);
  out.u32(static_cast<uint32_t>(material.bands.size()));
  for (auto band = material.bands.rbegin(); band != material.bands.rend(); ++band) writeBand(out, *band);
  writeMaps(out, material);
  out.u32(static_cast<uint32_t>(material.name.size()));
  out.text(material.name);
  return out.take();
}

Material decodeHeader(std::span<const std::byte> record, IssueList& issues) {
  return HeaderReader(record, issues).read();
}

}  // namespace loden::asset
