#include "importer/fit/band_pack.h"

#include <algorithm>
#include <cmath>

#include "importer/fit/grid_table.h"
#include "importer/fit/ycc_btf.h"
#include "importer/tile/charts.h"
#include "material/base/check.h"

namespace loden::importer {

TexelFormat formatOf(Storage storage) {
  switch (storage) {
    case Storage::kSnorm8:
      return TexelFormat::kRGBA8Snorm;
    case Storage::kSnorm16:
      return TexelFormat::kRGBA16Snorm;
    case Storage::kFloat32:
      return TexelFormat::kRGBA32Sfloat;
  }
  return TexelFormat::kRGBA8Snorm;
}

namespace {

// Where component c of a channel stands: Y fills quads from 0, Cb and Cr share the quads behind.
struct Place {
  int quad = 0, lane = 0;
};
Place placeOf(int channel, int c, int y_quads) {
  if (channel == 0) return {c / 4, c % 4};
  return {y_quads + c / 2, (channel == 1 ? 0 : 2) + c % 2};
}

double largest(std::span<const double> values) {
  double m = 0;
  for (double v : values) m = std::max(m, std::abs(v));
  return m;
}

// What a stored value is divided by: the largest magnitude where codes are normalised.
double scaleOf(std::span<const double> values, Storage storage) {
  const double m = largest(values);
  return storage == Storage::kFloat32 || m == 0 ? 1 : m;
}

void storeLane(Texture& texture, int mip, int x, int y, int z, int lane, double value) {
  glm::vec4 texel = fetchTexel(texture, mip, x, y, z);
  texel[lane] = static_cast<float>(value);
  storeTexel(texture, mip, x, y, z, texel);
}

// Mean of the texels below that belong to the same chart.
Matrix halvedInCharts(const Matrix& fine, int side, std::span<const uint16_t> owners,
                      std::span<const uint16_t> halved) {
  const int half = side / 2;
  Matrix coarse(half * half, 1);
  for (int j = 0; j < half; ++j)
    for (int i = 0; i < half; ++i) {
      const unsigned children = childrenOf(side, owners, halved, i, j);
      double sum = 0, count = 0;
      for (int k = 0; k < 4; ++k)
        if (children >> k & 1) sum += fine((2 * j + k / 2) * side + 2 * i + k % 2, 0), ++count;
      coarse(j * half + i, 0) = sum / count;
    }
  return coarse;
}

// `mips`: the first ones, one column each. owners: of mip 0 (PackOptions).
void storeWeights(Texture& texture, int layer, int lane, const std::vector<Matrix>& mips, int side,
                  double scale, std::vector<uint16_t> owners) {
  Matrix values;
  for (int mip = 0; mip < texture.mips; ++mip, side /= 2) {
    auto halved = mip == 0 || owners.empty() ? owners : halvedOwners(2 * side, owners);
    if (size_t(mip) < mips.size())
      values = mips[size_t(mip)];
    else
      values = owners.empty() ? downsample(values, 2 * side, BoxFilter::k2x2)
                              : halvedInCharts(values, 2 * side, owners, halved);
    owners = std::move(halved);
    for (int t = 0; t < side * side; ++t)
      storeLane(texture, mip, t % side, t / side, layer, lane, values.data[size_t(t)] / scale);
  }
}

void storeGridTable(Texture& texture, const DirectionGrid& grid, Place place, std::span<const double> table,
                    double scale) {
  const int dof = gridDof(grid);
  for (int ro = 0; ro < grid.thetas; ++ro)
    for (int co = 0; co < grid.phis; ++co)
      for (int ri = 0; ri < grid.thetas; ++ri)
        for (int ci = 0; ci < grid.phis; ++ci) {
          const double value =
              table[size_t(gridDofIndex(grid, ro, co)) * size_t(dof) + size_t(gridDofIndex(grid, ri, ci))];
          storeLane(texture, 0, ci, ro * grid.thetas + ri, place.quad * grid.phis + co, place.lane,
                    value / scale);
        }
}

void storeNearestTable(Texture& texture, int lights, Place place, std::span<const double> table,
                       double scale) {
  for (size_t i = 0; i < table.size(); ++i)
    storeLane(texture, 0, int(i) % lights, int(i) / lights, place.quad, place.lane, table[i] / scale);
}

Matrix oneColumn(std::span<const double> values) {
  Matrix m(static_cast<int>(values.size()), 1);
  std::copy(values.begin(), values.end(), m.data.begin());
  return m;
}

void storeRatio(Band& band, const std::vector<std::vector<glm::dvec2>>& ratio, int side,
                const PackOptions& options) {
  for (int lane = 0; lane < 2; ++lane) {
    std::vector<Matrix> mips;
    double scale = 0;
    for (const std::vector<glm::dvec2>& mip : ratio) {
      mips.emplace_back(static_cast<int>(mip.size()), 1);
      for (size_t t = 0; t < mip.size(); ++t) mips.back().data[t] = mip[t][lane];
      scale = std::max(scale, scaleOf(mips.back().data, options.storage));
    }
    band.ratio_scale[lane] = static_cast<float>(scale);
    storeWeights(band.weights, band.quads(), lane, mips, side, scale, options.owners);
  }
}

}  // namespace

Band packBand(const BandFactors& factors, const DirectionSet& lights, const DirectionSet& views,
              const PackOptions& options) {
  LODEN_CHECK_EQ(factors.cb.components(), factors.cr.components());
  const bool grid = options.layout == TableLayout::kGrid;
  Band band;
  band.layout = options.layout;
  band.y_quads = (factors.y.components() + 3) / 4;
  band.chroma_quads = (factors.cb.components() + 1) / 2;
  band.ratio = !factors.ratio.empty();
  band.quad_scale.assign(size_t(band.quads()), glm::vec4(1));
  band.quad_levels.resize(size_t(band.quads()));
  const TexelFormat format = formatOf(options.storage);
  band.weights = Texture::make(format, TextureShape::kArray2D, factors.side, factors.side,
                               band.layers() + options.spare_layers, options.mips);
  const DirectionGrid& g = options.grid;
  band.table =
      grid ? Texture::make(format, TextureShape::kVolume, g.phis, g.thetas * g.thetas, band.quads() * g.phis)
           : Texture::make(format, TextureShape::kVolume, lights.size(), views.size(), band.quads());
  const Matrix resample_light =
      grid && !factors.on_grid ? gridResampling(g, gridSampling(g, lights)) : Matrix();
  const Matrix resample_view =
      grid && !factors.on_grid ? gridResampling(g, gridSampling(g, views)) : Matrix();
  const Factors* channels[3] = {&factors.y, &factors.cb, &factors.cr};
  for (int channel = 0; channel < 3; ++channel) {
    const Factors& f = *channels[channel];
    if (f.components() == 0) continue;
    const Matrix tables =
        grid && !factors.on_grid ? mapTables(f.basis, resample_light, resample_view) : f.basis;
    for (int c = 0; c < f.components(); ++c) {
      const Place place = placeOf(channel, c, band.y_quads);
      const double weight_scale = scaleOf(f.weights.col(c), options.storage);
      const double table_scale = scaleOf(tables.col(c), options.storage);
      storeWeights(band.weights, place.quad, place.lane, {oneColumn(f.weights.col(c))}, factors.side,
                   weight_scale, options.owners);
      if (grid)
        storeGridTable(band.table, g, place, tables.col(c), table_scale);
      else
        storeNearestTable(band.table, lights.size(), place, tables.col(c), table_scale);
      band.quad_scale[size_t(place.quad)][place.lane] = static_cast<float>(weight_scale * table_scale);
    }
  }
  if (band.ratio) storeRatio(band, factors.ratio, factors.side, options);
  return band;
}

namespace {

Factors unpackChannel(const Band& band, const DirectionGrid& g, int channel, int lights, int views) {
  const bool grid = band.layout == TableLayout::kGrid;
  const int components = channel == 0 ? 4 * band.y_quads : 2 * band.chroma_quads;
  const int dof = gridDof(g), side = band.weights.width;
  Factors f{Matrix(side * side, components), Matrix(grid ? dof * dof : lights * views, components)};
  for (int c = 0; c < components; ++c) {
    const Place place = placeOf(channel, c, band.y_quads);
    for (int t = 0; t < side * side; ++t)
      f.weights(t, c) = double(fetchTexel(band.weights, 0, t % side, t / side, place.quad)[place.lane]);
    const double scale = double(band.quad_scale[size_t(place.quad)][place.lane]);
    for (int i = 0; i < f.basis.rows; ++i) {
      glm::vec4 texel;
      if (grid) {
        const auto rowColumn = [&](int d) {
          return d == 0 ? glm::ivec2(0, 0) : glm::ivec2((d - 1) / (g.phis - 1) + 1, (d - 1) % (g.phis - 1));
        };
        const glm::ivec2 o = rowColumn(i / dof), in = rowColumn(i % dof);
        texel = fetchTexel(band.table, 0, in.y, o.x * g.thetas + in.x, place.quad * g.phis + o.y);
      } else {
        texel = fetchTexel(band.table, 0, i % lights, i / lights, place.quad);
      }
      f.basis(i, c) = scale * double(texel[place.lane]);
    }
  }
  return f;
}

}  // namespace

BandFactors unpackBand(const Band& band, const DirectionGrid& grid, const DirectionSet& lights,
                       const DirectionSet& views) {
  BandFactors out;
  out.side = band.weights.width;
  Factors* channels[3] = {&out.y, &out.cb, &out.cr};
  for (int channel = 0; channel < 3; ++channel) {
    Factors& f = *channels[channel];
    f = unpackChannel(band, grid, channel, lights.size(), views.size());
    if (band.layout == TableLayout::kGrid && f.components() > 0)
      f.basis = mapTables(f.basis, gridSampling(grid, lights), gridSampling(grid, views));
  }
  if (band.ratio) out.ratio.emplace_back();
  for (int t = 0; band.ratio && t < out.side * out.side; ++t) {
    const glm::vec4 r =
        fetchTexel(band.weights, 0, t % out.side, t / out.side, band.quads()) * band.ratio_scale;
    out.ratio[0].push_back({r.x, r.y});
  }
  return out;
}

Matrix quantisedWeights(const Matrix& weights, Storage storage) {
  if (storage == Storage::kFloat32) return weights;
  const double codes = storage == Storage::kSnorm8 ? 127 : 32767;
  Matrix out = weights;
  for (int c = 0; c < out.cols; ++c) {
    const double scale = scaleOf(weights.col(c), storage);
    for (double& w : out.col(c)) w = std::round(w / scale * codes) / codes * scale;
  }
  return out;
}

}  // namespace loden::importer
