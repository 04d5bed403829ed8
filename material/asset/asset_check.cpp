#include "material/asset/asset_check.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

namespace loden::asset {
namespace {

using Limits = AssetLimits;
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
    issues_.require(bands <= Limits::kMaxBands, issue_id::kBandCount, "HEAD", bands, " bands; the limit is ",
                    Limits::kMaxBands);
    for (size_t i = 0; i < std::min<size_t>(bands, Limits::kMaxBands); ++i) checkBand(i);
    if (m_.geometry.texels.width != 0) checkGeometry();
    if (m_.stored_vdim) checkVdim(*m_.stored_vdim);
    if (m_.surface) checkSurface(*m_.surface);
  }

 private:
  template <class... Values>
  void header(bool holds, int id, const Values&... text) {
    issues_.require(holds, id, "HEAD", text...);
  }

  void checkHeader() {
    constexpr double kHalfPi = kPi / 2;
    header(m_.mode <= Mode::kFused, issue_id::kMode, "mode ", static_cast<uint32_t>(m_.mode), " is unknown");
    header(within(m_.side, 1, Limits::kMaxSide), issue_id::kSide, "side is not in 1..", Limits::kMaxSide);
    header(within(m_.lambda_min, 0, Limits::kMaxLambda), issue_id::kLambdaMin, "lambda_min ", m_.lambda_min,
           " is not in 0..", Limits::kMaxLambda);
    header(within(m_.lambda_max, 0, Limits::kMaxLambda), issue_id::kLambdaMax, "lambda_max ", m_.lambda_max,
           " is not in 0..", Limits::kMaxLambda);
    const bool lambdas =
        within(m_.lambda_min, 0, Limits::kMaxLambda) && within(m_.lambda_max, 0, Limits::kMaxLambda);
    header(!lambdas || m_.lambda_min <= m_.lambda_max, issue_id::kLambdaOrder, "lambda_min ", m_.lambda_min,
           " is above lambda_max ", m_.lambda_max);
    header(m_.value_scale > 0 && isValue(m_.value_scale), issue_id::kValueScale, "value_scale ",
           m_.value_scale, " is not positive, or above ", Limits::kMaxValue);
    const uint64_t finest = uint64_t{Limits::kMaxSideRatio} * static_cast<uint64_t>(greatestSide());
    header(!within(m_.side, 1, Limits::kMaxSide) || static_cast<uint64_t>(m_.side) <= finest,
           issue_id::kSideRatio, "side ", m_.side, " is more than ", Limits::kMaxSideRatio,
           " times that of any texture");
    header(m_.theta_max > 0 && m_.theta_max < kHalfPi, issue_id::kThetaMax, "theta_max ", m_.theta_max,
           " is not between 0 and pi / 2");
    header(within(m_.aspect, 1.0 / Limits::kMaxAspect, Limits::kMaxAspect), issue_id::kAspect, "aspect ",
           m_.aspect, " is not in 1 / ", Limits::kMaxAspect, "..", Limits::kMaxAspect);
    header(std::isfinite(m_.period) && m_.period >= 0, issue_id::kPeriod, "period ", m_.period,
           " is not 0 or positive");
    header(m_.geometry.texels.width == 0 || m_.geometry.aspect == m_.aspect, issue_id::kAspect, "aspect ",
           m_.aspect, " is not the geometry image's, ", m_.geometry.aspect);
    header(m_.name.size() <= Limits::kMaxNameBytes, issue_id::kNameBytes, "the name has ", m_.name.size(),
           " bytes; the limit is ", Limits::kMaxNameBytes);
    header(isText(m_.name, false), issue_id::kNameText,
           "the name is not UTF-8 text without control characters");
    header(m_.mode != Mode::kSurface || m_.bands.empty(), issue_id::kSurfaceBands,
           "a material of mode surface has bands");
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
      header(isValue(value), issue_id::kMeanCoefficient, "mean: a coefficient is not in -", Limits::kMaxValue,
             "..", Limits::kMaxValue);
    }
    header(!(mean.alpha < 0), issue_id::kMeanAlpha, "mean: alpha ", mean.alpha, " is negative");
    header(mean.chroma <= MeanChroma::kRatio, issue_id::kMeanChroma, "mean: chroma ",
           static_cast<uint32_t>(mean.chroma), " is unknown");
  }

  void checkDirections(const char* field, const DirectionSet& set) {
    const auto require = [&](bool holds, int id, const auto&... text) {
      issues_.require(holds, id, std::string("HEAD, ") + field, text...);
    };
    const uint32_t kind = static_cast<uint32_t>(set.kind);
    require(within(kind, 1, 4), issue_id::kDirectionKind, "kind ", kind, " is unknown");
    require(set.samples.size() <= Limits::kMaxDirections, issue_id::kDirectionCount, set.samples.size(),
            " samples; the limit is ", Limits::kMaxDirections);
    const bool concentric = set.kind == DirectionSetKind::kConcentric;
    const bool side_fits = concentric ? within(set.side, 1, 16) : set.side == 0;
    require(side_fits, issue_id::kDirectionSide, "side ", set.side, " does not fit the kind");
    if (!set.samples.empty() && side_fits) {
      const size_t expected = set.kind == DirectionSetKind::kBonn81   ? 81
                              : set.kind == DirectionSetKind::kUbo151 ? 151
                              : concentric ? static_cast<size_t>(set.side) * set.side
                                           : set.samples.size();
      require(set.samples.size() == expected, issue_id::kDirectionSet, set.samples.size(),
              " samples; its kind has ", expected);
    }
    for (size_t i = 0; i < set.samples.size(); ++i) {
      const glm::dvec3& w = set.samples[i];
      const bool unit = std::abs(glm::dot(w, w) - 1) < 1e-6;  // false for what is not finite
      require(unit, issue_id::kDirectionLength, "sample ", i, " is not a unit vector");
      require(!unit || w.z >= 0, issue_id::kDirectionBelow, "sample ", i, " is not of the upper hemisphere");
    }
  }

  void checkBand(size_t i) {
    const Band& band = m_.bands[i];
    const auto require = [&](bool holds, int id, const auto&... text) {
      issues_.require(holds, id, join("HEAD, band ", i), text...);
    };
    require(band.domain <= Domain::kFlat, issue_id::kBandDomain, "domain ",
            static_cast<uint32_t>(band.domain), " is unknown");
    require(m_.mode != Mode::kLod || band.domain != Domain::kFlat, issue_id::kLodFlatBand,
            "a material of mode lod has a flat band");
    require(band.filter <= WeightFilter::kLinear, issue_id::kBandFilter, "filter ",
            static_cast<uint32_t>(band.filter), " is unknown");
    require(band.layout <= TableLayout::kGrid, issue_id::kBandLayout, "layout ",
            static_cast<uint32_t>(band.layout), " is unknown");
    const Window& w = band.window;
    const bool finite = std::isfinite(w.in_begin) && std::isfinite(w.in_end) && std::isfinite(w.out_begin) &&
                        std::isfinite(w.out_end);
    require(finite, issue_id::kWindowFinite, "the window ", w.in_begin, ", ", w.in_end, ", ", w.out_begin,
            ", ", w.out_end, " is not finite");
    require(!finite || (w.in_begin < w.in_end && w.in_end <= w.out_begin && w.out_begin < w.out_end),
            issue_id::kWindowOrder, "the window ", w.in_begin, ", ", w.in_end, ", ", w.out_begin, ", ",
            w.out_end, " does not ascend");
    require(within(band.lambda_first, 0, Limits::kMaxLambda), issue_id::kBandLambda, "lambda_first ",
            band.lambda_first, " is not in 0..", Limits::kMaxLambda);
    if (i > 0) {
      issues_.require(!(band.lambda_first < m_.bands[i - 1].lambda_first), issue_id::kBandOrder,
                      join("HEAD, band ", i), "a finer band stands behind a coarser one");
    }
    const bool quads_fit =
        within(band.y_quads, 0, Limits::kMaxQuads) && within(band.chroma_quads, 0, Limits::kMaxQuads);
    require(quads_fit, issue_id::kQuadCount, "the numbers of quads are not in 0..", Limits::kMaxQuads);
    require(!quads_fit || band.quads() > 0, issue_id::kNoQuads, "no quad is of Y or chroma");
    for (const glm::vec4& scale : band.quad_scale) checkScale(scale, i, issue_id::kQuadScale, "quad_scale");
    checkScale(band.ratio_scale, i, issue_id::kRatioScale, "ratio_scale");
    if (!quads_fit || band.quads() == 0) return;
    require(within(band.lead_quads, 0, std::min(band.y_quads, band.quads() - 1)), issue_id::kLeadQuads,
            "lead_quads ", band.lead_quads, " is more than y_quads, or leaves no rest");
    require(band.quad_scale.size() == static_cast<size_t>(band.quads()), issue_id::kQuadScale,
            band.quad_scale.size(), " scales for ", band.quads(), " quads");
    require(band.quad_levels.size() == static_cast<size_t>(band.quads()), issue_id::kQuadLevels,
            band.quad_levels.size(), " levels for ", band.quads(), " quads");
    QuadLevels before;
    for (size_t q = 0; q < band.quad_levels.size(); ++q) {
      const QuadLevels& levels = band.quad_levels[q];
      require(within(levels.begin, before.begin, kNoEnd) && within(levels.end, -kNoEnd, before.end),
              issue_id::kQuadLevels, "quad ", q, " adds from ", levels.begin, " to ", levels.end,
              ", which is not within ", before.begin, " to ", before.end, " of the quad before");
      before = levels;
    }
    checkWeights(band, join("HEAD, band ", i, ", weights"));
    checkTable(band, join("HEAD, band ", i, ", table"));
  }

  void checkScale(const glm::vec4& value, size_t band, int id, const char* field) {
    issues_.require(isValue(value.x) && isValue(value.y) && isValue(value.z) && isValue(value.w), id,
                    join("HEAD, band ", band), field, " is not in -", Limits::kMaxValue, "..",
                    Limits::kMaxValue);
  }

  void checkWeights(const Band& band, const std::string& place) {
    const Texture& weights = band.weights;
    checkBandFormat(weights, issue_id::kWeightFormat, place);
    checkMips(weights, issue_id::kWeightMips, place);
    if (!checkExtents(weights, TextureShape::kArray2D, issue_id::kWeightExtent, place)) return;
    issues_.require(weights.width == weights.height, issue_id::kWeightSquare, place, "the map is not square");
    issues_.require(weights.depth >= band.layers(), issue_id::kWeightLayers, place, weights.depth,
                    " layers; the quads need ", band.layers());
  }

  void checkTable(const Band& band, const std::string& place) {
    const Texture& table = band.table;
    checkBandFormat(table, issue_id::kTableFormat, place);
    if (!checkExtents(table, TextureShape::kVolume, issue_id::kTableExtent, place)) return;
    if (band.layout > TableLayout::kGrid) return;  // said of the band
    int64_t x = m_.lights.size(), y = m_.views.size(), z = band.quads();
    if (band.layout == TableLayout::kGrid) {
      const DirectionGrid grid = tableGrid(band, m_.theta_max);
      issues_.require(
          within(grid.thetas, 2, Limits::kMaxGridSide) && within(grid.phis, 2, Limits::kMaxGridSide),
          issue_id::kTableGrid, place, grid.thetas, " x ", grid.phis, " directions; each is in 2..",
          Limits::kMaxGridSide);
      x = grid.phis;
      y = int64_t{grid.thetas} * grid.thetas;
      z *= grid.phis;
    }
    issues_.require(table.width == x && table.height == y && table.depth == z, issue_id::kTableSize, place,
                    "extents ", table.width, " x ", table.height, " x ", table.depth,
                    "; the layout and the directions need ", x, " x ", y, " x ", z);
  }

  void checkBandFormat(const Texture& texture, int id, const std::string& place) {
    const TexelFormat f = texture.format;
    issues_.require(f == TexelFormat::kRGBA8Snorm || f == TexelFormat::kRGBA16Snorm ||
                        f == TexelFormat::kRGBA16Sfloat || f == TexelFormat::kRGBA32Sfloat,
                    id, place, "format ", static_cast<uint32_t>(f), " cannot hold a band");
  }

  bool checkExtents(const Texture& t, TextureShape shape, int id, const std::string& place) {
    const auto fits = [](int extent) { return within(extent, 1, Limits::kMaxSide); };
    const bool all = t.shape == shape && (shape != TextureShape::kVolume || t.mips == 1) && fits(t.width) &&
                     fits(t.height) && fits(t.depth);
    issues_.require(all, id, place, "an extent is not in 1..", Limits::kMaxSide);
    return all;
  }

  bool checkMips(const Texture& t, int id, const std::string& place) {
    const int most = fullMipCount(std::max(t.width, 1), std::max(t.height, 1));
    const bool fit = within(t.mips, 1, most);
    issues_.require(fit, id, place, t.mips, " mips; the extents allow ", most);
    return fit;
  }

  // The extents of a map must be `width` x `height`, one layer, one mip, in `format`.
  void checkMap(const Texture& map, TexelFormat format, int64_t width, int64_t height, int id,
                const std::string& place) {
    if (!checkExtents(map, TextureShape::kArray2D, id, place)) return;
    issues_.require(map.format == format, id, place, "the format is not ", texelFormatName(format));
    issues_.require(map.width == width && map.height == height && map.depth == 1 && map.mips == 1, kMapSize,
                    place, "extents do not follow from the header's fields");
  }

  void checkGeometry() {
    const GeometryImage& geometry = m_.geometry;
    checkMap(geometry.texels, TexelFormat::kRGBA16Unorm, geometry.side(), geometry.side(),
             issue_id::kGeometrySide, "HEAD, geometry image");
    for (int axis = 0; axis < 3; ++axis) {
      const float range = geometry.range[axis];
      issues_.require(range >= 0 && range <= Limits::kMaxTilePeriods, issue_id::kGeometryRange,
                      "HEAD, geometry image", "range ", range, " is not in 0..", Limits::kMaxTilePeriods);
    }
    issues_.require(!within(geometry.side(), int{Limits::kMaxGeometrySide} + 1, Limits::kMaxSide),
                    issue_id::kGeometrySide, "HEAD, geometry image", "the side is above ",
                    Limits::kMaxGeometrySide);
    const VdimAtlasSize& atlas = m_.atlas;
    issues_.require(within(atlas.texels, 1, Limits::kMaxAtlasTexels), issue_id::kAtlasTexels,
                    "HEAD, geometry image", "an atlas of ", atlas.texels, " texels per side; they are in 1..",
                    Limits::kMaxAtlasTexels);
    issues_.require(within(atlas.directions, 1, Limits::kMaxAtlasDirections), issue_id::kAtlasDirections,
                    "HEAD, geometry image", "an atlas of ", atlas.directions,
                    " directions per side; they are in 1..", Limits::kMaxAtlasDirections);
  }

  void checkVdim(const PaperVdim& vdim) {
    const std::string place = "HEAD, stored VDIM";
    const size_t before = issues_.size();
    const auto count = [&](int value, int least, int id, const char* what) {
      issues_.require(within(value, least, Limits::kMaxSide), id, place, what, " ", value, " is not in ",
                      least, "..", Limits::kMaxSide);
    };
    count(vdim.side, 1, issue_id::kVdimSide, "side");
    count(vdim.zeniths, 2, issue_id::kVdimZeniths, "zeniths");
    count(vdim.azimuths, 2, issue_id::kVdimAzimuths, "azimuths");
    const bool counts = issues_.size() == before;
    for (int axis = 0; axis < 2; ++axis) {
      issues_.require(vdim.range[axis] >= 0 && vdim.range[axis] <= Limits::kMaxTilePeriods,
                      issue_id::kVdimRange, place, "range ", vdim.range[axis], " is not in 0..",
                      Limits::kMaxTilePeriods);
    }
    if (!counts) return;
    checkMap(vdim.reference, TexelFormat::kRG16Snorm, vdim.side, vdim.side, issue_id::kVdimSide,
             place + ", reference");
    checkMap(vdim.packed, TexelFormat::kRGBA16Snorm, int64_t{vdim.side} * vdim.azimuths,
             int64_t{vdim.side} * vdim.zeniths, issue_id::kVdimExtent, place + ", packed");
  }

  void checkSurface(const SurfaceMaps& maps) {
    const auto require = [&](bool holds, int id, const auto&... text) {
      issues_.require(holds, id, "HEAD, surface maps", text...);
    };
    require(m_.mode != Mode::kLod, issue_id::kLodMaps, "a material of mode lod has surface maps");
    require(maps.lobe <= Lobe::kGgx, issue_id::kLobe, "lobe ", static_cast<uint32_t>(maps.lobe),
            " is unknown");
    require(maps.visibility <= Visibility::kMap, issue_id::kVisibility, "visibility ",
            static_cast<uint32_t>(maps.visibility), " is unknown");
    require(within(maps.specular_scale, 0, Limits::kMaxSpecular), issue_id::kSpecularScale, "specular_scale ",
            maps.specular_scale, " is not in 0..", Limits::kMaxSpecular);
    for (const auto& [level, id] :
         {std::pair{maps.lambda_first, issue_id::kMapLevel}, {maps.ambient_first, issue_id::kAmbientLevel}})
      require(within(level, -double{Limits::kMaxFinerLevels}, Limits::kMaxLambda), id, "a first level ",
              level, " is not in -", Limits::kMaxFinerLevels, "..", Limits::kMaxLambda);
    const bool fades =
        within(maps.fade_begin, -kMostFade, kMostFade) && within(maps.fade_end, -kMostFade, kMostFade);
    require(fades, issue_id::kFadeRange, "the fade from ", maps.fade_begin, " to ", maps.fade_end,
            " is not in -", kMostFade, "..", kMostFade);
    require(!fades || maps.fade_begin < maps.fade_end, issue_id::kFadeOrder, "the fade from ",
            maps.fade_begin, " to ", maps.fade_end, " does not ascend");
    for (const SurfaceMapRow& row : kSurfaceMapRows) checkSurfaceMap(maps, row);
    const Texture &shadow = maps.shadow, &table = maps.shadow_table;
    require((shadow.width > 0) == (table.width > 0), issue_id::kShadowPair,
            "a shadow map and its table come together");
    require(maps.visibility != Visibility::kMap || shadow.width > 0, issue_id::kShadowMissing, "visibility ",
            static_cast<uint32_t>(maps.visibility), " without a shadow map");
    const auto likeAmbient = [&](const Texture& map) {
      return map.width == maps.ambient.width && map.height == maps.ambient.height &&
             map.mips == maps.ambient.mips;
    };
    require(maps.indirect.width == 0 || likeAmbient(maps.indirect), issue_id::kIndirectExtent,
            "the map of indirect light has other extents than the ambient map");
    if (shadow.width == 0 || table.width == 0) return;
    require(shadow.depth == table.depth && within(shadow.depth, 1, Limits::kMaxQuads),
            issue_id::kShadowLayers, "a shadow map of ", shadow.depth, " layers, and a table of ",
            table.depth, "; they are alike, and in 1..", Limits::kMaxQuads);
    require(likeAmbient(shadow), issue_id::kShadowExtent,
            "the shadow map has other extents than the ambient map");
    require(table.width == table.height && within(table.width, 2, Limits::kMaxGridSide) && table.mips == 1,
            issue_id::kShadowTable, "a shadow table of ", table.width, " x ", table.height,
            " directions and ", table.mips, " mips; it is square, of 2..", Limits::kMaxGridSide,
            " and one mip");
  }

  void checkSurfaceMap(const SurfaceMaps& maps, const SurfaceMapRow& row) {
    const Texture& map = maps.*row.texture;
    const std::string place = join("HEAD, ", row.name, " map");
    if (row.optional && map.width == 0 && map.height == 0 && map.depth == 0) return;
    issues_.require(map.format == row.format, issue_id::kMapLayers, place, "the format is not ",
                    texelFormatName(row.format));
    if (!checkExtents(map, TextureShape::kArray2D, issue_id::kMapExtent, place)) return;
    issues_.require(row.layers == 0 || map.depth == row.layers, issue_id::kMapLayers, place, map.depth,
                    " layers, not ", row.layers);
    if (!row.first) return;
    if (!checkMips(map, issue_id::kMapMips, place)) return;
    // From afar a map is its average, if no band takes over: one that ends earlier would pop where it comes
    // in.
    const bool whole = map.mips == fullMipCount(std::max(map.width, 1), std::max(map.height, 1));
    issues_.require(whole || !m_.bands.empty(), issue_id::kMapAverage, place, map.mips,
                    " mips do not end at one texel");
    const bool cut = row.first == &SurfaceMaps::lambda_first;  // what tail_mip is a mip of
    issues_.require(!cut || within(maps.tail_mip, 0, map.mips - 1), issue_id::kTailMip, place, "tail_mip ",
                    maps.tail_mip, " is none of its ", map.mips, " mips");
    issues_.require(!cut || maps.tail_mip == 0 || m_.bands.empty(), issue_id::kTailBands, place,
                    "maps of a material with bands have a tail");
  }

  const Material& m_;
  IssueList& issues_;
};

// Texels of floats whose bits without the sign are at most `most`, the greatest value that is allowed; those
// above `greatest` are not finite.
template <class Bits>
void checkFloatTexels(const std::vector<std::byte>& data, Bits most, Bits greatest, const std::string& place,
                      IssueList& issues) {
  constexpr Bits kMagnitude = std::numeric_limits<Bits>::max() >> 1;
  size_t beyond = 0, first_beyond = 0, infinite = 0, first_infinite = 0;
  for (size_t i = 0; i < data.size() / sizeof(Bits); ++i) {
    Bits bits;
    std::memcpy(&bits, data.data() + i * sizeof bits, sizeof bits);
    if ((bits & kMagnitude) <= most) continue;
    if ((bits & kMagnitude) > greatest) {
      if (infinite++ == 0) first_infinite = i;
    } else if (beyond++ == 0) {
      first_beyond = i;
    }
  }
  issues.require(infinite == 0, issue_id::kNonFinite, place, infinite,
                 " values are not finite, the first at ", first_infinite);
  issues.require(beyond == 0, issue_id::kTexelRange, place, beyond, " values are not in -", Limits::kMaxValue,
                 "..", Limits::kMaxValue, ", the first at ", first_beyond);
}

void checkTexels(const Texture& t, const std::string& place, IssueList& issues) {
  const uint64_t expected = textureBytes(t);
  issues.require(t.data.size() == expected, issue_id::kMapSize, place, t.data.size(),
                 " bytes; the extents need ", expected);
  if (t.format == TexelFormat::kRGBA16Sfloat)
    checkFloatTexels<uint16_t>(t.data, 0x7bff, 0x7bff, place, issues);
  if (t.format == TexelFormat::kRGBA32Sfloat)
    checkFloatTexels(t.data, std::bit_cast<uint32_t>(float(Limits::kMaxValue)),
                     std::bit_cast<uint32_t>(std::numeric_limits<float>::max()), place, issues);
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
    if (!zero) return issues.add(issue_id::kSpareLayer, place, "a spare layer of the weights is not zero");
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
      issues.add(status.issue().id, place, status.issue().text);
}

void checkMeta(const std::string& text, IssueList& issues) {
  issues.require(text.size() <= Limits::kMaxMetaBytes, issue_id::kMetaBytes, "META", text.size(),
                 " bytes; the limit is ", Limits::kMaxMetaBytes);
  issues.require(isText(text, true), issue_id::kMetaText, "META",
                 "the text is not UTF-8 without control characters other than tab and line ends");
}

}  // namespace loden::asset
