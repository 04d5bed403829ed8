// Mirrors shaders/loden_material.glsl name for name; keep the order of operations.

#include "material/eval/evaluate.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "material/base/check.h"
#include "material/model/color.h"

namespace loden {
namespace {

template <class T>
using V2 = glm::vec<2, T>;
template <class T>
using V3 = glm::vec<3, T>;
template <class T>
using V4 = glm::vec<4, T>;

// All levels from here on are alike: no asset has as many mips, and no window ends below.
constexpr float kMostLambda = 100;

// Where in the tables a pair of directions is: shares of a grid's extent, or the nearest samples' indices.
template <class T>
struct TablePosition {
  V2<T> light, view;  // (phi / 2 pi, theta / theta_max), 0..1
  int light_index = 0, view_index = 0;
};

int nearestIndex(const std::vector<uint8_t>& image, double x, double y) {
  const auto texel = [](double c) {
    return std::clamp(static_cast<int>((c * 0.5 + 0.5) * kNearestLookupSide), 0, kNearestLookupSide - 1);
  };
  return image.empty() ? 0 : image[static_cast<size_t>(texel(y)) * kNearestLookupSide + texel(x)];
}

template <class T>
V4<T> fetchTable(const Band& band, const DirectionGrid& grid, int quad, const TablePosition<T>& at) {
  if (band.layout == TableLayout::kNearest)
    return V4<T>(fetchTexel(band.table, 0, at.light_index, at.view_index, quad));
  const V2<T> cells(grid.phis - 1, grid.thetas - 1);
  const V2<T> light = at.light * cells, view = at.view * cells;
  const T row = std::min(std::floor(view.y), T(grid.thetas - 2));
  const T fraction = view.y - row;
  const V3<T> texel(light.x + T(0.5), row * T(grid.thetas) + light.y + T(0.5),
                    T(quad * grid.phis) + view.x + T(0.5));
  const V4<T> below = sampleVolume(band.table, texel);
  const V4<T> above = sampleVolume(band.table, texel + V3<T>(0, T(grid.thetas), 0));
  return glm::mix(below, above, fraction);
}

template <class T>
V4<T> fetchWeights(const Band& band, int layer, V2<T> q, T lambda) {
  if (band.filter == WeightFilter::kNearest) return nearestRepeat(band.weights, 0, layer, q);
  const T lod = std::clamp(lambda - T(band.lambda_first), T(0), T(band.weights.mips - 1));
  return sampleRepeatLod(band.weights, lod, layer, q);
}

// (Y, Cb, Cr) that one band adds at full weight.
template <class T>
V3<T> evaluateBand(const Band& band, float theta_max, const Hit<T>& hit, const TablePosition<T>& at,
                   const V3<T>& mean) {
  const DirectionGrid grid = tableGrid(band, theta_max);
  const V2<T> q = band.domain == Domain::kFlat ? hit.p : hit.x;
  V3<T> sum(0);
  for (int quad = 0; quad < band.quads(); ++quad) {
    const T share = quadShare(band, quad, hit.lambda);
    if (share <= T(0)) break;
    const V4<T> product = fetchWeights(band, quad, q, hit.lambda) * fetchTable(band, grid, quad, at) *
                          V4<T>(band.quad_scale[quad]) * share;
    if (quad < band.y_quads)
      sum.x += product.x + product.y + product.z + product.w;
    else
      sum += V3<T>(0, product.x + product.y, product.z + product.w);
  }
  if (band.ratio) {
    const V4<T> ratio = fetchWeights(band, band.quads(), q, hit.lambda) * V4<T>(band.ratio_scale);
    sum.y += ratio.x * (sum.x + mean.x) - mean.y;
    sum.z += ratio.y * (sum.x + mean.x) - mean.z;
  }
  return sum;
}

// Light of one colour channel per column; rows are Y, Cb, Cr.
template <class T>
using ColorMatrix = glm::mat<3, 3, T>;

// What the mean makes of light from all around.
template <class T>
ColorMatrix<T> evaluateMeanEnvironment(const Material& m, const EnvironmentMean& table,
                                       const HemisphereLight& light, const V3<T>& wo, T row) {
  const int below = std::min(static_cast<int>(row), kEnvironmentThetas - 2);
  const V4<T> t = glm::mix(V4<T>(table.rows[below]), V4<T>(table.rows[below + 1]), row - T(below));
  const T sine = std::sqrt(wo.x * wo.x + wo.y * wo.y);
  const V2<T> along = sine > T(1e-6) ? V2<T>(wo.x, wo.y) / sine : V2<T>(1, 0);
  ColorMatrix<T> ycc(0);
  for (int c = 0; c < 3; ++c) {
    const auto l = [&](int k) { return T(light.c[k][c]); };
    const T y = l(0) * t.x + l(1) * t.y + (l(2) * along.x + l(3) * along.y) * t.z +
                (l(4) * along.x * along.y + l(5) * (along.x * along.x - along.y * along.y)) * t.w;
    const T chroma =
        m.mean.chroma == MeanChroma::kRatio ? y : l(0) * T(table.unit.x) + l(1) * T(table.unit.y);
    ycc[c] = {y, T(m.mean.cb) * chroma, T(m.mean.cr) * chroma};
  }
  return ycc;
}

// evaluateBand for light from all around; `table` is the band's environmentTable, `view` as in TablePosition.
template <class T>
ColorMatrix<T> evaluateBandEnvironment(const Band& band, const Texture& table, const Hit<T>& hit,
                                       const V2<T>& view, const HemisphereLight& light,
                                       const ColorMatrix<T>& mean) {
  const V2<T> q = band.domain == Domain::kFlat ? hit.p : hit.x;
  ColorMatrix<T> sum(0);
  for (int quad = 0; quad < band.quads(); ++quad) {
    const T share = quadShare(band, quad, hit.lambda);
    if (share <= T(0)) break;
    std::array<V4<T>, 3> scattered{V4<T>(0), V4<T>(0), V4<T>(0)};
    for (int k = 0; k < kEnvironmentBasis; ++k) {
      const T slice = T(quad * kEnvironmentBasis + k) + T(0.5);
      const V4<T> texel = sampleVolume(
          table, V3<T>(view.x * T(table.width - 1) + T(0.5), view.y * T(table.height - 1) + T(0.5), slice));
      for (int c = 0; c < 3; ++c) scattered[c] += T(light.c[k][c]) * texel;
    }
    const V4<T> weights = fetchWeights(band, quad, q, hit.lambda) * share;
    for (int c = 0; c < 3; ++c) {
      const V4<T> product = weights * scattered[c];
      const V2<T> halves(product.x + product.y, product.z + product.w);
      sum[c] += quad < band.y_quads ? V3<T>(halves.x + halves.y, 0, 0) : V3<T>(0, halves);
    }
  }
  if (band.ratio) {
    const V4<T> ratio = fetchWeights(band, band.quads(), q, hit.lambda) * V4<T>(band.ratio_scale);
    for (int c = 0; c < 3; ++c) {
      sum[c].y += ratio.x * (sum[c].x + mean[c].x) - mean[c].y;
      sum[c].z += ratio.y * (sum[c].x + mean[c].x) - mean[c].z;
    }
  }
  return sum;
}

// A direction of the frame at x in the frame where the ray meets the tile, whose normal is that of x plus
// tilt. A vector that has none, as it is zero or not finite, counts as one from below.
template <class T>
V3<T> tilted(const V2<T>& tilt, const V3<T>& w) {
  const V2<T> xy(w.x, w.y);
  const V3<T> turned(xy - tilt * w.z, w.z + glm::dot(tilt, xy));
  const T square = glm::dot(turned, turned);
  return square > T(1e-30) && square < T(1e30) ? turned / std::sqrt(square) : V3<T>(0, 0, -1);
}

// Share of what is shown at this lambda that is read at p. Mirrors loden_parameter_share.
template <class T>
T parameterShare(const Material& material, T lambda) {
  T share = nearWeight(material, lambda);
  for (const Band& band : material.bands)
    if (band.domain == Domain::kFlat) share = std::max(share, windowWeight(band.window, lambda));
  return share;
}

}  // namespace

const char* modeName(Mode mode) {
  switch (mode) {
    case Mode::kSurface:
      return "surface";
    case Mode::kLod:
      return "lod";
    case Mode::kFused:
      return "fused";
  }
  return "unknown";
}

Evaluator::Evaluator(const Material& material, const ForEach& for_each) : material_(&material) {
  if (!material.geometry.empty() && material.mode != Mode::kLod)
    atlas_ = buildVdimAtlas(material.geometry, material.atlas, for_each);
  if (material.lights.size() > 0)
    nearest_light_ = nearestDirectionLookup(material.lights, kNearestLookupSide);
  if (material.views.size() > 0) nearest_view_ = nearestDirectionLookup(material.views, kNearestLookupSide);
}

VdimMaps Evaluator::vdimMaps() const {
  VdimMaps maps;
  if (material_->stored_vdim) maps.paper = &*material_->stored_vdim;
  if (!atlas_.depth.empty()) maps.atlas = &atlas_;
  if (tracer_) maps.tracer = &*tracer_;
  return maps;
}

void Evaluator::prepareQuality() {
  if (!atlas_.depth.empty()) tracer_.emplace(material_->geometry, Interpolation::kCubic);
}

template <class T>
T parallaxFade(const Material& material, T lambda, const glm::vec<3, T>& wo) {
  if (!material.geometry.identity_parameterization) return T(1);
  const V2<T> along = V2<T>(periodsPerLength(material.geometry.aspect)) * V2<T>(wo.x, wo.y);
  T slope = std::sqrt(glm::dot(along, along)) / std::max(wo.z, T(std::cos(kThetaMax)));
  // Shadows show from above, too; the light is taken to come at 45 degrees at least.
  if (material.surface && byLookup(material.surface->visibility)) slope = std::max(slope, T(1));
  const T texels =
      T(std::max(material.geometry.range.z, 1e-9f)) * slope * T(material.side) * std::exp2(-lambda);
  return std::clamp(T(4) * texels - T(1), T(0), T(1));
}

template <class T>
Hit<T> Evaluator::findHit(glm::vec<2, T> x, T lambda, const glm::vec<3, T>& wo, Lookup lookup,
                          Parallax parallax, const LocalSurface<T>& surface) const {
  Hit<T> hit;
  hit.x = hit.p = x;
  // The finest if lambda is no number.
  hit.lambda = std::min(std::max(T(finestLevel(*material_)), lambda), T(kMostLambda));
  hit.position = V3<T>(x, T(0));
  hit.surface = surface;
  // As published, beyond the last level the last level stays (LBTF 3.4, step 2).
  if (material_->mode == Mode::kLod) hit.lambda = std::min(hit.lambda, T(material_->lambda_max));
  if (nearWeight(*material_, hit.lambda) > 0) {
    const SurfaceMaps& near = *material_->surface;
    hit.fetches = 2 + (near.visibility == Visibility::kMap ? near.shadow.depth : 0) + near.indirect.depth;
  }
  const VdimMaps maps = vdimMaps();
  if (!maps.serve(lookup)) return hit;
  // No ray comes from nowhere, or from no direction.
  if (!std::isfinite(x.x + x.y + wo.x + wo.y + wo.z)) return hit;
  const bool fades = parallax == Parallax::kFaded && lookup != Lookup::kPaper;
  const T fade = fades ? parallaxFade(*material_, hit.lambda, wo) : T(1);
  const T share = parameterShare(*material_, hit.lambda);
  if (!(fade > 0) || (!(share > 0) && lookup != Lookup::kPaper)) return hit;
  const T footprint = std::exp2(hit.lambda) / T(material_->side);
  const VdimHit<T> found = vdimLookup(maps, lookup, x, wo, surface, footprint);
  hit.p = glm::mix(x, found.p, fade);
  hit.position = V3<T>(x + found.offset * fade, found.position.z * fade);
  hit.relief = lookup != Lookup::kPaper && !found.missed;
  hit.lookup = lookup;
  hit.depth = found.height * fade * std::min(T(2) * share, T(1));
  const T shown = fade * share;
  hit.tilt = surface.curvature * (glm::inverse(surface.x_from_tangent) * found.offset) * shown;
  hit.missed = found.missed && shown >= T(0.5);
  hit.fetches += found.fetches;
  return hit;
}

template <class T>
glm::mat<3, 3, T> hitFrame(const Hit<T>& hit, const glm::mat<3, 3, T>& frame) {
  return {glm::normalize(frame[0] - hit.tilt.x * frame[2]), glm::normalize(frame[1] - hit.tilt.y * frame[2]),
          glm::normalize(hit.tilt.x * frame[0] + hit.tilt.y * frame[1] + frame[2])};
}

template <class T>
glm::vec<3, T> Evaluator::evaluate(const Hit<T>& hit, const glm::vec<3, T>& wi_ts,
                                   const glm::vec<3, T>& wo_ts) const {
  const Material& m = *material_;
  const V3<T> wi = tilted(hit.tilt, wi_ts), wo = tilted(hit.tilt, wo_ts);
  if (wi.z <= 0 || wo.z <= 0) return V3<T>(0);
  const T near = nearWeight(m, hit.lambda);
  const V3<T> shown = near > 0 ? near * evaluateNearTerm(hit, wi, wo) : V3<T>(0);
  if (!(near < 1)) return shown;

  const T theta_max = T(m.theta_max);
  const V3<T> light = clampTheta(wi, theta_max), view = clampTheta(wo, theta_max);
  const T cosine = m.cosine_included ? std::min(wi.z / std::cos(theta_max), T(1)) : wi.z;
  const V3<T> mean = evaluateMean(m.mean, light, view);
  TablePosition<T> at;
  at.light = gridPosition(light, theta_max);
  at.view = gridPosition(view, theta_max);
  at.light_index = nearestIndex(nearest_light_, double(light.x), double(light.y));
  at.view_index = nearestIndex(nearest_view_, double(view.x), double(view.y));
  V3<T> ycc = mean;
  for (const Band& band : m.bands) {
    const T weight = windowWeight(band.window, hit.lambda);
    if (weight > 0) ycc += weight * evaluateBand(band, m.theta_max, hit, at, mean);
  }
  return shown + (T(1) - near) * (glm::max(rgbFromYcc(ycc), V3<T>(0)) * cosine);
}

template <class T>
glm::vec<3, T> Evaluator::evaluateNearTerm(const Hit<T>& hit, const glm::vec<3, T>& wi,
                                           const glm::vec<3, T>& wo) const {
  const SurfaceMaps& maps = *material_->surface;
  const NearPoint<T> point = nearPoint(maps, hit.p, hit.lambda);
  const V3<T> indirect = indirectLight(maps, point, hit.p, hit.lambda, wi);
  if (glm::dot(point.mapped, wi) <= 0) return indirect;
  // No better for the light than for the eye.
  const bool fast = maps.visibility == Visibility::kFast || hit.lookup == Lookup::kFast;
  const Lookup lookup = fast ? Lookup::kFast : Lookup::kDefault;
  T visibility = T(1);
  if (byLookup(maps.visibility) && hit.relief && !hit.missed)
    visibility = lookedUpVisibility(atlas_, lookup, hit.surface, hit.position, hit.p, point.normal, wi,
                                    std::exp2(hit.lambda) / T(material_->side));
  else if (maps.visibility == Visibility::kMap)
    visibility = mappedVisibility(maps, hit.p, hit.lambda, wi);
  if (!(visibility > T(0))) return indirect;
  return visibility * evaluateNear(maps.lobe, point, wi, wo) + indirect;
}

void Evaluator::prepareEnvironment() {
  environment_mean_ = environmentMean(*material_);
  environment_tables_.clear();
  for (const Band& band : material_->bands) environment_tables_.push_back(environmentTable(*material_, band));
}

template <class T>
glm::vec<3, T> Evaluator::evaluateEnvironment(const Hit<T>& hit, const HemisphereLight& light,
                                              const glm::vec<3, T>& wo_ts) const {
  const Material& m = *material_;
  const V3<T> wo = tilted(hit.tilt, wo_ts);
  if (wo.z <= 0) return V3<T>(0);
  const T near = nearWeight(m, hit.lambda);
  V3<T> shown(0);
  if (near > 0)
    shown = near * evaluateNearEnvironment(*m.surface, nearPoint(*m.surface, hit.p, hit.lambda), hit.p,
                                           hit.lambda, light, wo);
  if (!(near < 1)) return shown;
  LODEN_CHECK_EQ(environment_tables_.size(), m.bands.size());
  const V3<T> view = clampTheta(wo, T(m.theta_max));
  const V2<T> at = gridPosition(view, T(m.theta_max));
  const ColorMatrix<T> mean =
      evaluateMeanEnvironment(m, environment_mean_, light, view, at.y * T(kEnvironmentThetas - 1));
  ColorMatrix<T> ycc = mean;
  for (size_t b = 0; b < m.bands.size(); ++b) {
    const T weight = windowWeight(m.bands[b].window, hit.lambda);
    if (weight > 0)
      ycc += weight * evaluateBandEnvironment(m.bands[b], environment_tables_[b], hit, at, light, mean);
  }
  return shown +
         (T(1) - near) *
             glm::max(V3<T>(rgbFromYcc(ycc[0]).x, rgbFromYcc(ycc[1]).y, rgbFromYcc(ycc[2]).z), V3<T>(0));
}

glm::vec4 tableValue(const Material& material, const Band& band, int quad, const glm::vec3& wi,
                     const glm::vec3& wo) {
  TablePosition<float> at;
  at.light = gridPosition(wi, material.theta_max);
  at.view = gridPosition(wo, material.theta_max);
  if (band.layout == TableLayout::kNearest) {
    at.light_index = nearestDirection(material.lights, glm::dvec3(wi));
    at.view_index = nearestDirection(material.views, glm::dvec3(wo));
  }
  return fetchTable(band, tableGrid(band, material.theta_max), quad, at);
}

template glm::mat3 hitFrame(const Hit<float>&, const glm::mat3&);
template glm::dmat3 hitFrame(const Hit<double>&, const glm::dmat3&);
template float parallaxFade(const Material&, float, const glm::vec<3, float>&);
template double parallaxFade(const Material&, double, const glm::vec<3, double>&);
template Hit<float> Evaluator::findHit(glm::vec<2, float>, float, const glm::vec<3, float>&, Lookup, Parallax,
                                       const LocalSurface<float>&) const;
template Hit<double> Evaluator::findHit(glm::vec<2, double>, double, const glm::vec<3, double>&, Lookup,
                                        Parallax, const LocalSurface<double>&) const;
template glm::vec<3, float> Evaluator::evaluate(const Hit<float>&, const glm::vec<3, float>&,
                                                const glm::vec<3, float>&) const;
template glm::vec<3, double> Evaluator::evaluate(const Hit<double>&, const glm::vec<3, double>&,
                                                 const glm::vec<3, double>&) const;
template glm::vec<3, float> Evaluator::evaluateEnvironment(const Hit<float>&, const HemisphereLight&,
                                                           const glm::vec<3, float>&) const;
template glm::vec<3, double> Evaluator::evaluateEnvironment(const Hit<double>&, const HemisphereLight&,
                                                            const glm::vec<3, double>&) const;

}  // namespace loden
