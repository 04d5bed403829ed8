#include "material/asset/asset_check.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

namespace loden::asset {
namespace {

using Limits = AssetLimits;
using issue_id::kBandField;
using issue_id::kDirections;
using issue_id::kHeaderField;
using issue_id::kMapField;
using issue_id::kMapSize;

bool within(double value, double low, double high) {
  return value >= low && value <= high;
}

// What products of weight, table and scales stay finite with, in single precision.
bool isValue(float value) {
  return within(value, -double(Limits::kMaxValue), Limits::kMaxValue);
}

// Well-formed UTF-8 (RFC 3629) without control characters other than, where `lines` allows, tab and line
// ends.
bool isText(const std::string& text, bool lines) {
  for (size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i++]);
    if (lead < 0x80) {
      const bool line_end = lead == '\t' || lead == '\n' || lead == '\r';
      if (lead == 0x7f || (lead < ' ' && !(lines && line_end))) return false;
      continue;
    }
    const int more = lead >= 0xf0 ? 3 : lead >= 0xe0 ? 2 : 1;
    if (lead < 0xc2 || lead > 0xf4 || text.size() - i < static_cast<size_t>(more)) return false;
    uint32_t code = lead & (0x3f >> more);
    for (int k = 0; k < more; ++k) {
      const auto next = static_cast<unsigned char>(text[i++]);
      if ((next & 0xc0) != 0x80) return false;
      code = code << 6 | (next & 0x3f);
    }
    constexpr uint32_t kLeast[] = {0, 0x80, 0x800, 0x10000};
    if (code < kLeast[more] || code > 0x10ffff || (code >= 0xd800 && code <= 0xdfff)) return false;
  }
  return true;
}

constexpr double kMostFade = 1e5;  // of lambda, where a near term begins or ends to fade

class MaterialCheck {
 public:
  MaterialCheck(const Material& material, IssueList& issues) : m_(material), issues_(issues) {}

  void run() {
    checkHeader();
    checkMean();
    checkDirections("lights", m_.lights);
    checkDirections("views", m_.views);
    const size_t bands = m_.bands.size();
    issues_.require(bands <= Limits::kMaxBands, issue_id::kLimit, "HEAD", bands, " bands; the limit is ",
                    Limits::kMaxBands);
    for (size_t i = 0; i < std::min<size_t>(bands, Limits::kMaxBands); ++i) checkBand(i);
    if (m_.geometry.texels.width != 0) checkGeometry();
    if (m_.stored_vdim) checkVdim(*m_.stored_vdim);
    if (m_.surface) checkSurface(*m_.surface);
  }

 private:
  template <class... Values>
  void header(bool holds, const Values&... text) {
    issues_.require(holds, kHeaderField, "HEAD", text...);
  }

  void checkHeader() {
    constexpr double kHalfPi = kPi / 2;
    header(m_.mode <= Mode::kFused, "mode ", static_cast<uint32_t>(m_.mode), " is unknown");
    header(within(m_.side, 1, Limits::kMaxSide), "side is not in 1..", Limits::kMaxSide);
    header(within(m_.lambda_min, 0, Limits::kMaxLambda), "lambda_min ", m_.lambda_min, " is not in 0..",
           Limits::kMaxLambda);
    header(within(m_.lambda_max, 0, Limits::kMaxLambda), "lambda_max ", m_.lambda_max, " is not in 0..",
           Limits::kMaxLambda);
    header(m_.value_scale > 0 && isValue(m_.value_scale), "value_scale ", m_.value_scale,
           " is not positive, or above ", Limits::kMaxValue);
    const uint64_t finest = uint64_t{Limits::kMaxSideRatio} * static_cast<uint64_t>(greatestSide());
    header(m_.side < 0 || static_cast<uint64_t>(m_.side) <= finest, "side ", m_.side, " is more than ",
           Limits::kMaxSideRatio, " times that of any texture");
    header(m_.theta_max > 0 && m_.theta_max < kHalfPi, "theta_max ", m_.theta_max,
           " is not between 0 and pi / 2");
    header(within(m_.aspect, 1.0 / Limits::kMaxAspect, Limits::kMaxAspect), "aspect ", m_.aspect,
           " is not in 1 / ", Limits::kMaxAspect, "..", Limits::kMaxAspect);
    header(std::isfinite(m_.period) && m_.period >= 0, "period ", m_.period, " is not 0 or positive");
    header(m_.geometry.texels.width == 0 || m_.geometry.aspect == m_.aspect, "aspect ", m_.aspect,
           " is not the geometry image's, ", m_.geometry.aspect);
    header(m_.name.size() <= Limits::kMaxNameBytes && isText(m_.name, false),
           "name is not UTF-8 text without control characters, of at most ", Limits::kMaxNameBytes, " bytes");
    header(m_.mode != Mode::kSurface || m_.bands.empty(), "a material of mode surface has bands");
  }

  // Of the textures that are read over x or p; 1 if there are none.
  int greatestSide() const {
    int side = std::max(1, m_.geometry.texels.width);
    for (const Band& band : m_.bands) side = std::max(side, band.weights.width);
    if (m_.stored_vdim) side = std::max(side, m_.stored_vdim->side);
    if (m_.surface)
      for (const SurfaceMapRow& row : kSurfaceMapRows)
        if (const Texture& map = (*m_.surface).*row.texture; row.first)
          side = std::max({side, map.width, map.height});
    return side;
  }

  void checkMean() {
    const PhongMean& mean = m_.mean;
    for (const float value : {mean.ka, mean.kd, mean.ks, mean.alpha, mean.cb, mean.cr}) {
      header(isValue(value), "mean: a coefficient is not in -", Limits::kMaxValue, "..", Limits::kMaxValue);
    }
    header(!(mean.alpha < 0), "mean: alpha ", mean.alpha, " is negative");
    header(mean.chroma <= MeanChroma::kRatio, "mean: chroma ", static_cast<uint32_t>(mean.chroma),
           " is unknown");
  }

  void checkDirections(const char* field, const DirectionSet& set) {
    const auto require = [&](bool holds, const auto&... text) {
      issues_.require(holds, kDirections, std::string("HEAD, ") + field, text...);
    };
    const uint32_t kind = static_cast<uint32_t>(set.kind);
    require(within(kind, 1, 4), "kind ", kind, " is unknown");
    require(set.samples.size() <= Limits::kMaxDirections, set.samples.size(), " samples; the limit is ",
            Limits::kMaxDirections);
    const bool concentric = set.kind == DirectionSetKind::kConcentric;
    require(concentric ? within(set.side, 1, 16) : set.side == 0, "side ", set.side,
            " does not fit the kind");
    if (!set.samples.empty()) {
      const size_t expected = set.kind == DirectionSetKind::kBonn81   ? 81
                              : set.kind == DirectionSetKind::kUbo151 ? 151
                              : concentric ? static_cast<size_t>(set.side) * set.side
                                           : set.samples.size();
      require(set.samples.size() == expected, set.samples.size(), " samples; its kind has ", expected);
    }
    for (size_t i = 0; i < set.samples.size(); ++i) {
      const glm::dvec3& w = set.samples[i];
      const bool unit = std::abs(glm::dot(w, w) - 1) < 1e-6;  // false for what is not finite
      require(unit && w.z >= 0, "sample ", i, " is not a unit vector of the upper hemisphere");
    }
  }

  void checkBand(size_t i) {
    const Band& band = m_.bands[i];
    const auto require = [&](bool holds, const auto&... text) {
      issues_.require(holds, kBandField, join("HEAD, band ", i), text...);
    };
    require(band.domain <= Domain::kFlat, "domain ", static_cast<uint32_t>(band.domain), " is unknown");
    require(m_.mode != Mode::kLod || band.domain == Domain::kReference,
            "a material of mode lod has a flat band");
    require(band.filter <= WeightFilter::kLinear, "filter ", static_cast<uint32_t>(band.filter),
            " is unknown");
    require(band.layout <= TableLayout::kGrid, "layout ", static_cast<uint32_t>(band.layout), " is unknown");
    const Window& w = band.window;
    const bool finite = std::isfinite(w.in_begin) && std::isfinite(w.out_end);
    require(finite && w.in_begin < w.in_end && w.in_end <= w.out_begin && w.out_begin < w.out_end,
            "the window ", w.in_begin, ", ", w.in_end, ", ", w.out_begin, ", ", w.out_end,
            " does not ascend");
    require(within(band.lambda_first, 0, Limits::kMaxLambda), "lambda_first ", band.lambda_first,
            " is not in 0..", Limits::kMaxLambda);
    if (i > 0) {
      issues_.require(!(band.lambda_first < m_.bands[i - 1].lambda_first), issue_id::kOrder,
                      join("HEAD, band ", i), "a finer band stands behind a coarser one");
    }
    const bool quads_fit = within(band.y_quads, 0, Limits::kMaxQuads) &&
                           within(band.chroma_quads, 0, Limits::kMaxQuads) && band.quads() > 0;
    require(quads_fit, "the numbers of quads are not in 0..", Limits::kMaxQuads,
            ", or none is of Y or chroma");
    for (const glm::vec4& scale : band.quad_scale) checkScale(scale, i, "quad_scale");
    checkScale(band.ratio_scale, i, "ratio_scale");
    if (!quads_fit) return;
    require(within(band.lead_quads, 0, std::min(band.y_quads, band.quads() - 1)), "lead_quads ",
            band.lead_quads, " is more than y_quads, or leaves no rest");
    require(band.quad_scale.size() == static_cast<size_t>(band.quads()), band.quad_scale.size(),
            " scales for ", band.quads(), " quads");
    checkWeights(band, join("HEAD, band ", i, ", weights"));
    checkTable(band, join("HEAD, band ", i, ", table"));
  }

  void checkScale(const glm::vec4& value, size_t band, const char* field) {
    issues_.require(isValue(value.x) && isValue(value.y) && isValue(value.z) && isValue(value.w), kBandField,
                    join("HEAD, band ", band), field, " is not in -", Limits::kMaxValue, "..",
                    Limits::kMaxValue);
  }

  void checkWeights(const Band& band, const std::string& place) {
    checkBandFormat(band.weights, place);
    checkExtents(band.weights, TextureShape::kArray2D, kBandField, place);
    issues_.require(band.weights.width == band.weights.height, kBandField, place, "the map is not square");
    issues_.require(band.weights.depth >= band.layers(), kBandField, place, band.weights.depth,
                    " layers; the quads need ", band.layers());
  }

  void checkTable(const Band& band, const std::string& place) {
    const Texture& table = band.table;
    checkBandFormat(table, place);
    checkExtents(table, TextureShape::kVolume, kBandField, place);
    int64_t x = m_.lights.size(), y = m_.views.size(), z = band.quads();
    if (band.layout == TableLayout::kGrid) {
      const DirectionGrid grid = tableGrid(band, m_.theta_max);
      issues_.require(
          within(grid.thetas, 2, Limits::kMaxGridSide) && within(grid.phis, 2, Limits::kMaxGridSide),
          kBandField, place, grid.thetas, " x ", grid.phis, " directions; each is in 2..",
          Limits::kMaxGridSide);
      x = grid.phis;
      y = int64_t{grid.thetas} * grid.thetas;
      z *= grid.phis;
    }
    issues_.require(table.width == x && table.height == y && table.depth == z, kBandField, place, "extents ",
                    table.width, " x ", table.height, " x ", table.depth,
                    "; the layout and the directions need ", x, " x ", y, " x ", z);
  }

  void checkBandFormat(const Texture& texture, const std::string& place) {
    const TexelFormat f = texture.format;
    issues_.require(f == TexelFormat::kRGBA8Snorm || f == TexelFormat::kRGBA16Snorm ||
                        f == TexelFormat::kRGBA16Sfloat || f == TexelFormat::kRGBA32Sfloat,
                    kBandField, place, "format ", static_cast<uint32_t>(f), " cannot hold a band");
  }

  void checkExtents(const Texture& t, TextureShape shape, int id, const std::string& place) {
    const auto fits = [](int extent) { return within(extent, 1, Limits::kMaxSide); };
    issues_.require(t.shape == shape, id, place, "the texture has the wrong shape");
    issues_.require(fits(t.width) && fits(t.height) && fits(t.depth), issue_id::kLimit, place,
                    "an extent is not in 1..", Limits::kMaxSide);
    const int most =
        shape == TextureShape::kVolume ? 1 : fullMipCount(std::max(t.width, 1), std::max(t.height, 1));
    issues_.require(within(t.mips, 1, most), id, place, t.mips, " mips; the extents allow ", most);
  }

  // The extents of a map must be `width` x `height`, one layer, one mip, in `format`.
  void checkMap(const Texture& map, TexelFormat format, int64_t width, int64_t height,
                const std::string& place) {
    checkExtents(map, TextureShape::kArray2D, kMapField, place);
    issues_.require(map.format == format, kMapField, place, "the format is not ", texelFormatName(format));
    issues_.require(map.width == width && map.height == height && map.depth == 1 && map.mips == 1, kMapSize,
                    place, "extents do not follow from the header's fields");
  }

  void checkGeometry() {
    const GeometryImage& geometry = m_.geometry;
    checkMap(geometry.texels, TexelFormat::kRGBA16Unorm, geometry.side(), geometry.side(),
             "HEAD, geometry image");
    for (int axis = 0; axis < 3; ++axis) {
      const float range = geometry.range[axis];
      issues_.require(range >= 0 && range <= Limits::kMaxTilePeriods, kMapField, "HEAD, geometry image",
                      "range ", range, " is not in 0..", Limits::kMaxTilePeriods);
    }
    issues_.require(geometry.side() <= int{Limits::kMaxGeometrySide}, issue_id::kLimit,
                    "HEAD, geometry image", "the side is above ", Limits::kMaxGeometrySide);
    const VdimAtlasSize& atlas = m_.atlas;
    issues_.require(within(atlas.texels, 1, Limits::kMaxAtlasTexels) &&
                        within(atlas.directions, 1, Limits::kMaxAtlasDirections),
                    kMapField, "HEAD, geometry image", "an atlas of ", atlas.texels, " x ", atlas.directions,
                    " texels and directions per side; they are in 1..", Limits::kMaxAtlasTexels, " and 1..",
                    Limits::kMaxAtlasDirections);
  }

  void checkVdim(const PaperVdim& vdim) {
    const std::string place = "HEAD, stored VDIM";
    const bool counts = within(vdim.side, 1, Limits::kMaxSide) && within(vdim.zeniths, 2, Limits::kMaxSide) &&
                        within(vdim.azimuths, 2, Limits::kMaxSide);
    issues_.require(counts, kMapField, place, "side, zeniths or azimuths is out of range");
    for (int axis = 0; axis < 2; ++axis) {
      issues_.require(vdim.range[axis] >= 0 && vdim.range[axis] <= Limits::kMaxTilePeriods, kMapField, place,
                      "range ", vdim.range[axis], " is not in 0..", Limits::kMaxTilePeriods);
    }
    if (!counts) return;
    checkMap(vdim.reference, TexelFormat::kRG16Snorm, vdim.side, vdim.side, place + ", reference");
    checkMap(vdim.packed, TexelFormat::kRGBA16Snorm, int64_t{vdim.side} * vdim.azimuths,
             int64_t{vdim.side} * vdim.zeniths, place + ", packed");
  }

  void checkSurface(const SurfaceMaps& maps) {
    const auto require = [&](bool holds, const auto&... text) {
      issues_.require(holds, kMapField, "HEAD, surface maps", text...);
    };
    require(m_.mode != Mode::kLod, "a material of mode lod has surface maps");
    require(maps.lobe <= Lobe::kGgx, "lobe ", static_cast<uint32_t>(maps.lobe), " is unknown");
    require(maps.visibility <= Visibility::kMap, "visibility ", static_cast<uint32_t>(maps.visibility),
            " is unknown");
    require(within(maps.specular_scale, 0, Limits::kMaxSpecular), "specular_scale ", maps.specular_scale,
            " is not in 0..", Limits::kMaxSpecular);
    for (const float level : {maps.lambda_first, maps.ambient_first})
      require(within(level, -double{Limits::kMaxFinerLevels}, Limits::kMaxLambda), "a first level ", level,
              " is not in -", Limits::kMaxFinerLevels, "..", Limits::kMaxLambda);
    require(within(maps.fade_begin, -kMostFade, kMostFade) && within(maps.fade_end, -kMostFade, kMostFade) &&
                maps.fade_begin < maps.fade_end,
            "the fade from ", maps.fade_begin, " to ", maps.fade_end, " does not ascend, or is not in -",
            kMostFade, "..", kMostFade);
    for (const SurfaceMapRow& row : kSurfaceMapRows) checkSurfaceMap(maps, row);
    const Texture &shadow = maps.shadow, &table = maps.shadow_table;
    require((shadow.width > 0) == (table.width > 0), "a shadow map and its table come together");
    require(maps.visibility != Visibility::kMap || shadow.width > 0, "visibility ",
            static_cast<uint32_t>(maps.visibility), " without a shadow map");
    if (shadow.width == 0 || table.width == 0) return;
    require(shadow.depth == table.depth && within(shadow.depth, 1, Limits::kMaxQuads), "a shadow map of ",
            shadow.depth, " layers, and a table of ", table.depth, "; they are alike, and in 1..",
            Limits::kMaxQuads);
    require(shadow.width == maps.ambient.width && shadow.height == maps.ambient.height &&
                shadow.mips == maps.ambient.mips,
            "the shadow map has other extents than the ambient map");
    require(table.width == table.height && within(table.width, 2, Limits::kMaxGridSide) && table.mips == 1,
            "a shadow table of ", table.width, " x ", table.height, " directions and ", table.mips,
            " mips; it is square, of 2..", Limits::kMaxGridSide, " and one mip");
  }

  void checkSurfaceMap(const SurfaceMaps& maps, const SurfaceMapRow& row) {
    const Texture& map = maps.*row.texture;
    const std::string place = join("HEAD, ", row.name, " map");
    if (row.layers == 0 && map.width == 0 && map.height == 0 && map.depth == 0) return;
    checkExtents(map, TextureShape::kArray2D, kMapField, place);
    issues_.require(map.format == row.format, kMapField, place, "the format is not ",
                    texelFormatName(row.format));
    issues_.require(row.layers == 0 || map.depth == row.layers, kMapSize, place, map.depth, " layers, not ",
                    row.layers);
    if (!row.first) return;
    // From afar a map is its average, if no band takes over: one that ends earlier would pop where it comes
    // in.
    const bool whole = map.mips == fullMipCount(std::max(map.width, 1), std::max(map.height, 1));
    issues_.require(whole || !m_.bands.empty(), kMapField, place, map.mips, " mips do not end at one texel");
    const bool cut = row.first == &SurfaceMaps::lambda_first;  // what tail_mip is a mip of
    issues_.require(!cut || within(maps.tail_mip, 0, map.mips - 1), kMapField, place, "tail_mip ",
                    maps.tail_mip, " is none of its ", map.mips, " mips");
    issues_.require(!cut || maps.tail_mip == 0 || m_.bands.empty(), kMapField, place,
                    "maps of a material with bands have a tail");
  }

  const Material& m_;
  IssueList& issues_;
};

// Texels of floats whose bits without the sign are at most `most`, the greatest value that is allowed.
template <class Bits>
void checkFloatTexels(const std::vector<std::byte>& data, Bits most, const std::string& place,
                      IssueList& issues) {
  constexpr Bits kMagnitude = std::numeric_limits<Bits>::max() >> 1;
  size_t bad = 0, first = 0;
  for (size_t i = 0; i < data.size() / sizeof(Bits); ++i) {
    Bits bits;
    std::memcpy(&bits, data.data() + i * sizeof bits, sizeof bits);
    if ((bits & kMagnitude) > most && bad++ == 0) first = i;
  }
  issues.require(bad == 0, issue_id::kNonFinite, place, bad, " values are not finite, or not in -",
                 Limits::kMaxValue, "..", Limits::kMaxValue, ", the first at ", first);
}

void checkTexels(const Texture& t, const std::string& place, IssueList& issues) {
  const uint64_t expected = textureBytes(t);
  issues.require(t.data.size() == expected, issue_id::kMapSize, place, t.data.size(),
                 " bytes; the extents need ", expected);
  if (t.format == TexelFormat::kRGBA16Sfloat) checkFloatTexels<uint16_t>(t.data, 0x7bff, place, issues);
  if (t.format == TexelFormat::kRGBA32Sfloat)
    checkFloatTexels(t.data, std::bit_cast<uint32_t>(float(Limits::kMaxValue)), place, issues);
}

// Layers beyond those that a band uses hold zeros.
void checkSpareLayers(const Band& band, const std::string& place, IssueList& issues) {
  const Texture& weights = band.weights;
  for (int mip = 0; mip < weights.mips; ++mip) {
    const size_t layer = weights.mipBytes(mip) / weights.depth;
    const auto begin = weights.data.begin() + static_cast<ptrdiff_t>(weights.mipOffset(mip));
    const bool zero = std::all_of(begin + static_cast<ptrdiff_t>(layer * band.layers()),
                                  begin + static_cast<ptrdiff_t>(weights.mipBytes(mip)),
                                  [](std::byte value) { return value == std::byte{0}; });
    if (!zero) return issues.add(issue_id::kBandField, place, "a spare layer of the weights is not zero");
  }
}

}  // namespace

void checkMaterial(const Material& material, IssueList& issues) {
  MaterialCheck(material, issues).run();
}

void checkPartTexels(const Material& material, const Part& part, const std::string& place,
                     IssueList& issues) {
  for (const Texture* texture : partTextures(material, part)) {
    checkTexels(*texture, place, issues);
    if (texture->data.size() != textureBytes(*texture)) return;
  }
  if (part.type == kBand) checkSpareLayers(material.bands[part.band], place, issues);
  if (part.type == kGeom)
    if (Status status = checkVdimWork(material.geometry, material.atlas); !status)
      issues.add(kMapField, place, status.issue().text);
}

void checkMeta(const std::string& text, IssueList& issues) {
  issues.require(text.size() <= Limits::kMaxMetaBytes && isText(text, true), issue_id::kHeaderField, "META",
                 "the text is not UTF-8 of at most ", Limits::kMaxMetaBytes, " bytes");
}

}  // namespace loden::asset
