// Building the atlas from the geometry image, and the direction grid that it is sampled on.

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

#include "material/check.h"
#include "material/vdim.h"

namespace loden {
namespace {

constexpr int kVolumeSide = 32, kVolumeDepth = 8;

// atanh(sin(kThetaMax)): the radius of the rim before scaling to 1.
double rimRadius() {
  static const double kRim = std::atanh(std::sin(kThetaMax));
  return kRim;
}

// Runs body(k) for k in [0, count) on `threads` threads (0: all); every k once, in no order.
template <class Body>
void parallelFor(int count, int threads, const Body& body) {
  if (threads <= 0) threads = std::max(1u, std::thread::hardware_concurrency());
  std::atomic<int> next{0};
  const auto work = [&] {
    for (int k; (k = next.fetch_add(1)) < count;) body(k);
  };
  std::vector<std::jthread> pool;
  for (int t = 1; t < std::min(threads, count); ++t) pool.emplace_back(work);
  work();
}

void traceLayer(const GeometryTracer& tracer, const VdimAtlasSize& size, double z_min, int layer, Texture& depth) {
  const glm::dvec2 square((layer % size.directions + 0.5) / size.directions,
                          (layer / size.directions + 0.5) / size.directions);
  const glm::dvec3 wo = vdimViewFromSquare(square);
  const size_t texels = static_cast<size_t>(size.texels) * size.texels;
  auto* codes = reinterpret_cast<uint8_t*>(depth.data.data()) + layer * texels;
  for (size_t k = 0; k < texels; ++k) {
    const glm::dvec2 x((k % size.texels + 0.5) / size.texels, (k / size.texels + 0.5) / size.texels);
    const auto hit = tracer.traceView(x, wo);
    const double z = hit ? hit->position.z : z_min;
    codes[k] = static_cast<uint8_t>(std::lround(255 * std::clamp(1 - z / z_min, 0.0, 1.0)));
  }
}

// p - X.xy of the surface point nearest to the voxel's centre, into [-.5, .5].
glm::dvec2 nearestDisplacement(const std::vector<glm::dvec3>& points, const std::vector<glm::dvec2>& params,
                               const glm::dvec3& centre) {
  double best = 1e30;
  size_t found = 0;
  for (size_t k = 0; k < points.size(); ++k) {
    glm::dvec3 d = points[k] - centre;
    d.x -= std::nearbyint(d.x);
    d.y -= std::nearbyint(d.y);
    const double distance = glm::dot(d, d);
    if (distance < best) best = distance, found = k;
  }
  glm::dvec2 displacement = params[found] - glm::dvec2(points[found]);
  return displacement - glm::dvec2(std::nearbyint(displacement.x), std::nearbyint(displacement.y));
}

Texture buildVolume(const GeometryImage& image, int threads) {
  std::vector<glm::dvec3> points;
  std::vector<glm::dvec2> params;
  const int n = image.side();
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const Patch<double> patch = fetchPatch<double>(image, i, j);
      if (patch.chart == 0) continue;
      points.push_back(0.25 * (patch.p00 + patch.p10 + patch.p01 + patch.p11));
      params.emplace_back((i + 1.0) / n, (j + 1.0) / n);
    }
  Texture volume =
      Texture::make(TexelFormat::kRG16Snorm, TextureShape::kVolume, kVolumeSide, kVolumeSide, kVolumeDepth);
  if (points.empty()) return volume;
  parallelFor(kVolumeDepth * kVolumeSide, threads, [&](int row) {
    const int y = row % kVolumeSide, z = row / kVolumeSide;
    for (int x = 0; x < kVolumeSide; ++x) {
      const glm::dvec3 centre((x + 0.5) / kVolumeSide, (y + 0.5) / kVolumeSide,
                              (z + 0.5) / kVolumeDepth * image.zMin());
      const glm::dvec2 d = nearestDisplacement(points, params, centre);
      storeTexel(volume, 0, x, y, z, glm::vec4(2.0f * glm::vec2(d), 0, 0));
    }
  });
  return volume;
}

}  // namespace

uint64_t vdimAtlasBytes(const GeometryImage& image, VdimAtlasSize size) {
  const auto square = [](int side) { return uint64_t(side) * uint64_t(side); };
  const uint64_t depth = textureBytes(TexelFormat::kR8Unorm, square(size.texels), 1, square(size.directions), 1);
  const uint64_t maps = depth + textureBytes(TexelFormat::kRGBA8Unorm, square(image.side()), 1, 1, 1);
  if (image.identity_parameterization) return maps;
  return maps + textureBytes(TexelFormat::kRG16Snorm, kVolumeSide, kVolumeSide, kVolumeDepth, 1);
}

template <class T>
glm::vec<2, T> vdimSquareFromView(const glm::vec<3, T>& wo) {
  const T sine = std::sqrt(wo.x * wo.x + wo.y * wo.y);
  if (sine <= T(1e-6)) return {T(0.5), T(0.5)};
  const T clamped = std::min(sine, T(std::sin(kThetaMax)));
  // atanh(s) = log((1 + s) / (1 - s)) / 2
  const T radius = T(0.5) * std::log((T(1) + clamped) / (T(1) - clamped)) / T(rimRadius());
  return squareFromDisk(glm::vec<2, T>(wo.x, wo.y) * (std::min(radius, T(1)) / sine));
}

template glm::vec<2, float> vdimSquareFromView(const glm::vec<3, float>&);
template glm::vec<2, double> vdimSquareFromView(const glm::vec<3, double>&);

glm::dvec3 vdimViewFromSquare(glm::dvec2 square) {
  const glm::dvec2 disk = diskFromSquare(square);
  const double radius = glm::length(disk);
  if (radius < 1e-12) return {0, 0, 1};
  const double sine = std::tanh(std::min(radius, 1.0) * rimRadius());
  return {disk * (sine / radius), std::sqrt(1 - sine * sine)};
}

VdimAtlas buildVdimAtlas(const GeometryImage& image, const GeometryTracer& tracer, VdimAtlasSize size, int threads) {
  LODEN_CHECK_LT(0, size.texels);
  LODEN_CHECK_LT(0, size.directions);
  VdimAtlas atlas;
  atlas.size = size;
  atlas.geometry = packGeometry(image);
  const int layers = size.directions * size.directions;
  atlas.depth = Texture::make(TexelFormat::kR8Unorm, TextureShape::kArray2D, size.texels, size.texels, layers);
  parallelFor(layers, threads,
              [&](int layer) { traceLayer(tracer, atlas.size, -atlas.geometry.range.z, layer, atlas.depth); });
  if (!image.identity_parameterization) atlas.volume = buildVolume(image, threads);
  return atlas;
}

}  // namespace loden
