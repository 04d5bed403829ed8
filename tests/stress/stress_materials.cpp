#include "tests/stress/stress_materials.h"

#include <array>
#include <cmath>

#include "tests/unit/material_fixtures.h"

namespace loden::stress {
namespace {

// Directions of a grid's node; the pole has one whatever its column.
glm::dvec3 nodeDirection(const DirectionGrid& grid, int row, int column) {
  return directionFromSpherical(
      {double(grid.theta_max) * row / (grid.thetas - 1), 2 * kPi * column / (grid.phis - 1)});
}

void storeLane(Texture& texture, int mip, glm::ivec3 at, int lane, double value) {
  glm::vec4 texel = fetchTexel(texture, mip, at.x, at.y, at.z);
  texel[lane] = static_cast<float>(value);
  storeTexel(texture, mip, at.x, at.y, at.z, texel);
}

}  // namespace

double smoothEigenValue(int component, const glm::dvec3& wi, const glm::dvec3& wo) {
  const double c = component + 1;
  return 0.5 * std::sin(1.3 * wi.x * c + 0.7 * wo.y) + 0.3 * std::cos(wi.y - c * wo.x) * wi.z + 0.2 * wo.z;
}

double smoothWeight(int component, glm::dvec2 x) {
  return 0.6 / (component + 1) *
         (1 + 0.5 * std::sin(2 * kPi * x.x + component) * std::cos(2 * kPi * x.y - component));
}

constexpr QuadLevels kQuadLevels[] = {{}, {0.25f, 2.5f}, {0.5f, 2.0f}};

Material smoothMaterial(int side) {
  Material m;
  m.mode = Mode::kLod;
  m.name = "smooth";
  m.side = side;
  m.mean = {0.05f, 0.4f, 0, 1, 0.02f, -0.01f, MeanChroma::kRatio};
  Band band;
  band.y_quads = 2, band.chroma_quads = 1;
  band.quad_scale.assign(3, glm::vec4(0.1f));
  band.quad_levels.assign(std::begin(kQuadLevels), std::end(kQuadLevels));
  const DirectionGrid grid{6, 25, m.theta_max};
  const int mips = fullMipCount(side, side);
  m.lambda_max = float(mips - 1);
  band.weights = Texture::make(TexelFormat::kRGBA32Sfloat, TextureShape::kArray2D, side, side, 3, mips);
  band.table = Texture::make(TexelFormat::kRGBA32Sfloat, TextureShape::kVolume, grid.phis,
                             grid.thetas * grid.thetas, 3 * grid.phis);
  for (int c = 0; c < 12; ++c) {
    for (int mip = 0; mip < mips; ++mip)
      for (int t = 0; t < (side >> mip) * (side >> mip); ++t) {
        const int s = side >> mip;
        const glm::dvec2 x = glm::dvec2(t % s + 0.5, t / s + 0.5) / double(s);
        storeLane(band.weights, mip, {t % s, t / s, c / 4}, c % 4, smoothWeight(c, x) * std::exp2(-mip));
      }
    for (int ro = 0; ro < grid.thetas; ++ro)
      for (int co = 0; co < grid.phis; ++co)
        for (int ri = 0; ri < grid.thetas; ++ri)
          for (int ci = 0; ci < grid.phis; ++ci)
            storeLane(band.table, 0, {ci, ro * grid.thetas + ri, c / 4 * grid.phis + co}, c % 4,
                      smoothEigenValue(c, nodeDirection(grid, ri, ci), nodeDirection(grid, ro, co)));
  }
  m.bands.push_back(std::move(band));
  return m;
}

namespace {

constexpr int kThetas = 6, kPhis = 25;
const DirectionGrid kGrid{kThetas, kPhis, static_cast<float>(75.0 * kPi / 180.0)};

// Two neighbours and the weight of the second.
struct Between {
  int low, high;
  double share;
};

// The four nodes around a direction.
struct Around {
  Between row, column;
};
Around around(const glm::dvec3& w) {
  const double theta = std::min(std::acos(std::min(w.z, 1.0)), double(kGrid.theta_max));
  double phi = std::atan2(w.y, w.x);
  if (phi < 0) phi += 2 * kPi;
  const double r = theta / double(kGrid.theta_max) * (kThetas - 1), c = phi / (2 * kPi) * (kPhis - 1);
  const int row = std::min(static_cast<int>(r), kThetas - 2),
            column = std::min(static_cast<int>(c), kPhis - 2);
  return {{row, row + 1, r - row}, {column, column + 1, c - column}};
}

double tableAt(int component, const Around& light, const Around& view) {
  double sum = 0;
  for (int k = 0; k < 16; ++k) {
    const auto pick = [&](const Between& b, int bit, double& weight) {
      weight *= k >> bit & 1 ? b.share : 1 - b.share;
      return k >> bit & 1 ? b.high : b.low;
    };
    double weight = 1;
    const int ri = pick(light.row, 0, weight), ci = pick(light.column, 1, weight),
              ro = pick(view.row, 2, weight), co = pick(view.column, 3, weight);
    sum += weight * smoothEigenValue(component, nodeDirection(kGrid, ri, ci), nodeDirection(kGrid, ro, co));
  }
  return sum;
}

double weightAt(int component, int side, glm::dvec2 x) {
  const glm::dvec2 texel = (x - glm::floor(x)) * double(side) - 0.5, base = glm::floor(texel),
                   f = texel - base;
  double sum = 0;
  for (int k = 0; k < 4; ++k) {
    const glm::dvec2 corner(k % 2, k / 2);
    const double weight = (k % 2 ? f.x : 1 - f.x) * (k / 2 ? f.y : 1 - f.y);
    sum += weight * smoothWeight(component, (base + corner + 0.5) / double(side));
  }
  return sum;
}

}  // namespace

glm::dvec3 smoothValue(int side, glm::dvec2 x, double lambda, const glm::dvec3& light,
                       const glm::dvec3& view) {
  const glm::dvec3 wi = glm::normalize(light), wo = glm::normalize(view);
  if (!(wi.z > 0) || !(wo.z > 0)) return glm::dvec3(0);
  const int last = fullMipCount(side, side) - 1;
  const double level = std::min(std::max(lambda, 0.0), double(last));
  const int mip = std::min(static_cast<int>(level), std::max(last - 1, 0));
  const Around i = around(wi), o = around(wo);
  const double limit = std::cos(double(kGrid.theta_max));
  const double mean = 0.05f + 0.4f * std::max(wi.z, limit);
  double ycc[3] = {0, 0, 0};
  for (int c = 0; c < 12; ++c) {
    const double fine = weightAt(c, side >> mip, x) * std::exp2(-mip);
    const double coarse = last == 0 ? fine : weightAt(c, side >> (mip + 1), x) * std::exp2(-mip - 1);
    const double value = 0.1f * (fine + (level - mip) * (coarse - fine)) * tableAt(c, i, o);
    const QuadLevels& levels = kQuadLevels[c / 4];
    const double share =
        std::clamp(std::min(level - double(levels.begin), double(levels.end) - level), 0.0, 1.0);
    ycc[c < 8 ? 0 : c % 4 < 2 ? 1 : 2] += share * value;
  }
  const double y = mean + ycc[0], cb = 0.02f * mean + ycc[1], cr = -0.01f * mean + ycc[2];
  // BT.601.
  const glm::dvec3 rgb(y + 1.402 * cr, y - 0.114 * 1.772 / 0.587 * cb - 0.299 * 1.402 / 0.587 * cr,
                       y + 1.772 * cb);
  return glm::max(rgb, glm::dvec3(0)) * std::min(wi.z / limit, 1.0);
}

namespace {

// `texture` in another format; where that holds -1 to 1 only, each channel of each layer is divided by its
// largest magnitude, which `scales` gets per layer.
Texture converted(const Texture& texture, TexelFormat format, int layers, std::vector<glm::vec4>& scales) {
  const bool normalised = format == TexelFormat::kRGBA8Snorm || format == TexelFormat::kRGBA16Snorm;
  Texture out =
      Texture::make(format, texture.shape, texture.width, texture.height, texture.depth, texture.mips);
  const int depth = texture.depth / layers;  // slices of one
  scales.assign(size_t(layers), glm::vec4(1));
  for (int layer = 0; layer < layers; ++layer) {
    const auto visit = [&](const auto& body) {
      for (int mip = 0; mip < texture.mips; ++mip)
        for (int z = layer * depth; z < (layer + 1) * depth; ++z)
          for (int y = 0; y < texture.mipHeight(mip); ++y)
            for (int x = 0; x < texture.mipWidth(mip); ++x) body(mip, x, y, z);
    };
    glm::vec4 most(0);
    visit([&](int mip, int x, int y, int z) {
      most = glm::max(most, glm::abs(fetchTexel(texture, mip, x, y, z)));
    });
    if (normalised) scales[size_t(layer)] = most;
    visit([&](int mip, int x, int y, int z) {
      storeTexel(out, mip, x, y, z, fetchTexel(texture, mip, x, y, z) / scales[size_t(layer)]);
    });
  }
  return out;
}

}  // namespace

Material stored(const Material& exact, TexelFormat format) {
  Material m = exact;
  Band& band = m.bands[0];
  std::vector<glm::vec4> weights, table;
  band.weights = converted(exact.bands[0].weights, format, band.quads(), weights);
  band.table = converted(exact.bands[0].table, format, band.quads(), table);
  for (size_t q = 0; q < band.quad_scale.size(); ++q) band.quad_scale[q] *= weights[q] * table[q];
  return m;
}

std::vector<Material> edgeMaterials() {
  std::vector<Material> all{test::surfaceMaterial(), test::lodMaterial(), test::fusedMaterial(),
                            test::nearMaterial(),    smoothMaterial(),    planeMaterial(0.2)};
  all.front().surface->visibility = Visibility::kDefault;
  return all;
}

GeometryImage planeImage(int side, double depth, bool identity) {
  std::vector<glm::dvec3> positions;
  for (int t = 0; t < side * side; ++t)
    positions.emplace_back((t % side + 0.5) / side, (t / side + 0.5) / side, -depth);
  return encodeGeometryImage(side, positions, std::vector<uint16_t>(positions.size(), 1), identity);
}

Material planeMaterial(double depth) {
  Material m;
  m.mode = Mode::kSurface;
  m.name = "plane";
  m.side = 32;
  m.geometry = planeImage(32, depth);
  SurfaceMaps maps;
  maps.normal = Texture::make(TexelFormat::kRGBA8Snorm, TextureShape::kArray2D, 1, 1, 1);
  maps.color = Texture::make(TexelFormat::kRGBA8Unorm, TextureShape::kArray2D, 1, 1, 1);
  maps.ambient = Texture::make(TexelFormat::kRGBA8Snorm, TextureShape::kArray2D, 1, 1, 2);
  storeTexel(maps.normal, 0, 0, 0, 0, {0, 0, 1, 0});
  storeTexel(maps.color, 0, 0, 0, 0, {1, 1, 1, 0});
  storeTexel(maps.ambient, 0, 0, 0, 0, {1, 2.0f / 3, 0, 0});
  maps.specular_scale = 0;
  m.surface = maps;
  return m;
}

double bumpHeight(glm::dvec2 p, double depth) {
  return depth * (std::cos(4 * kPi * p.x) * std::cos(4 * kPi * p.y) - 1) / 2;
}

GeometryImage bumpImage(int side, double depth) {
  std::vector<glm::dvec3> positions;
  for (int t = 0; t < side * side; ++t) {
    const glm::dvec2 p((t % side + 0.5) / side, (t / side + 0.5) / side);
    positions.emplace_back(p, bumpHeight(p, depth));
  }
  return encodeGeometryImage(side, positions, std::vector<uint16_t>(positions.size(), 1), true);
}

}  // namespace loden::stress
