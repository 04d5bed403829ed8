// Rays against closed surfaces: none may pass. Through vertices and edges, along seams, grazing, at any
// offset, at any size of the tile.

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>

#include "importer/base/parallel.h"
#include "importer/base/random.h"
#include "importer/tile/tile_tracer.h"
#include "material/model/geometry_image.h"
#include "tests/stress/stress.h"
#include "tests/stress/stress_materials.h"
#include "tests/unit/importer_meshes.h"

namespace loden::stress {
namespace {

using namespace importer;

// Whole periods that a place is moved by.
constexpr double kOffsets[] = {0, 1, -1, 1e3, -1e5, 1e6};

glm::dvec2 offsetOf(uint64_t seed) {
  return {kOffsets[mixSeed(seed, 20) % std::size(kOffsets)],
          kOffsets[mixSeed(seed, 21) % std::size(kOffsets)]};
}

// Views: straight down, along an axis, and oblique ones down to `least` above the horizon, half of them
// among the lowest.
glm::dvec3 viewOf(uint64_t seed, double least) {
  const double u = uniform(seed, 1), phi = 2 * kPi * uniform(seed, 2);
  const uint64_t kind = mixSeed(seed, 3) % 16;
  if (kind == 0) return {0, 0, 1};
  const double z = kind < 8 ? least * std::pow(1 / least, u) : least + (1 - least) * u,
               sine = std::sqrt(1 - z * z);
  if (kind == 1 || kind == 2) return {kind == 1 ? sine : -sine, 0, z};
  if (kind == 3 || kind == 4) return {0, kind == 3 ? sine : -sine, z};
  if (kind == 5) return {sine * std::sqrt(0.5), -sine * std::sqrt(0.5), z};
  return {sine * std::cos(phi), sine * std::sin(phi), z};
}

// How often a ray passes a surface that it cannot pass.
struct Leaks {
  std::atomic<int64_t> rays{0}, nothing_met{0}, target_passed{0}, moved{0}, shadow_rays{0}, shadow_leaks{0};
  std::atomic<int64_t> vertex_rays{0}, vertex_leaks{0};  // shadow rays exactly through a vertex, from below
};

void note(const std::string& what, const Leaks& leaks) {
  record(what + ": view rays", double(leaks.rays), "tried");
  record(what + ": view rays that meet nothing", double(leaks.nothing_met), "0");
  record(what + ": view rays that pass the vertex, edge or face they aim at", double(leaks.target_passed),
         "0");
  if (leaks.shadow_rays > 0) {
    record(what + ": shadow rays from below the surface", double(leaks.shadow_rays), "tried");
    record(what + ": shadow rays from below the surface that see the sky", double(leaks.shadow_leaks), "0");
  }
  if (leaks.vertex_rays > 0)
    record(what +
               ": share of shadow rays exactly through a vertex or edge, from below, that see the sky, of " +
               std::to_string(leaks.vertex_rays),
           double(leaks.vertex_leaks) / double(leaks.vertex_rays), "<= 1e-3");
  EXPECT_LE(double(leaks.vertex_leaks), 1e-3 * double(leaks.vertex_rays)) << what;
  EXPECT_EQ(leaks.nothing_met, 0) << what;
  EXPECT_EQ(leaks.target_passed, 0) << what;
  EXPECT_EQ(leaks.shadow_leaks, 0) << what;
}

// --- the tracer over geometry images ---

// Walls, hills and noise; the last leans over.
GeometryImage someImage(int which, double depth) {
  constexpr int kSide = 48;
  std::vector<glm::dvec3> positions;
  for (int t = 0; t < kSide * kSide; ++t) {
    const glm::dvec2 p = glm::dvec2(t % kSide + 0.5, t / kSide + 0.5) / double(kSide);
    glm::dvec3 at(p, bumpHeight(p, depth));
    if (which == 1) at.z = -depth * uniform(5, uint64_t(t));
    if (which == 2) at.z = -depth * (t / 6 % 2);
    if (which == 3)
      at = {p.x + 0.2 * std::cos(4 * kPi * p.x), p.y, -depth * (1 - std::cos(4 * kPi * p.x)) / 2};
    positions.push_back(at);
  }
  return encodeGeometryImage(kSide, positions, std::vector<uint16_t>(positions.size(), 1), which != 3);
}

// A point of the image's triangles: a vertex, on one of its three kinds of edges, or inside; of patches whose
// row or column is at the seam more often.
glm::dvec3 targetOf(const GeometryImage& image, uint64_t seed) {
  const auto index = [&](uint64_t k) {
    const uint64_t pick = mixSeed(seed, k);
    return static_cast<int>(pick % 4 == 0 ? (pick / 4 % 2 == 0 ? -1 : image.side() - 1)
                                          : pick / 4 % uint64_t(image.side()));
  };
  const Patch<double> patch = fetchPatch<double>(image, index(4), index(5));
  const double u = uniform(seed, 6), v = uniform(seed, 7);
  switch (mixSeed(seed, 8) % 5) {
    case 0:
      return patch.p00;
    case 1:
      return glm::mix(patch.p00, patch.p10, u);
    case 2:
      return glm::mix(patch.p00, patch.p01, u);
    case 3:
      return glm::mix(patch.p00, patch.p11, u);
    default:
      return u > v ? patch.p00 + (u - v) * (patch.p10 - patch.p00) + v * (patch.p11 - patch.p00)
                   : patch.p00 + u * (patch.p11 - patch.p00) + (v - u) * (patch.p01 - patch.p00);
  }
}

TEST(StressRays, NoneLeaksThroughGeometryImages) {
  Leaks leaks;
  const int64_t rays = amount(1'000'000, 100'000'000) / 16;
  for (const double depth : {1e-4, 1e-2, 0.15, 2.0})
    for (int which = 0; which < 4; ++which) {
      const GeometryImage image = someImage(which, depth);
      const GeometryTracer tracer(image);
      // Lower rays cross more cells: as low as some 20 periods of way.
      const double least = std::clamp(depth / 20, 1e-3, 0.1);
      constexpr int64_t kBatch = 1000;
      parallelFor(size_t((rays + kBatch - 1) / kBatch), 0, [&](size_t batch) {
        int64_t nothing = 0, passed = 0, moved = 0, shadow_leaks = 0;
        for (int64_t k = 0; k < kBatch; ++k) {
          const uint64_t seed =
              mixSeed(uint64_t(which) + uint64_t(depth * 1e6), batch * kBatch + uint64_t(k));
          const glm::dvec3 wo = viewOf(seed, least);
          const glm::dvec2 offset = offsetOf(seed);
          const glm::dvec3 target = targetOf(image, seed) + glm::dvec3(offset, 0);
          const auto hit = tracer.traceView(glm::dvec2(target) - glm::dvec2(wo) / wo.z * target.z, wo);
          nothing += !hit;
          // Far away x is rounded, and the ray with it: it has to be that of the rounded x in the first
          // period. In the nearest thousand a double is right to 1.1e-13, which faces that are steep or
          // nearly along the ray magnify.
          const bool far = glm::length(offset) > 2e3;
          if (far) {
            const glm::dvec2 x = glm::dvec2(target) - glm::dvec2(wo) / wo.z * target.z;
            const auto same = tracer.traceView(x - glm::floor(x), wo);
            moved += hit && same &&
                     largestOf(hit->position - same->position - glm::dvec3(glm::floor(x), 0)) > 1e-9;
          }
          passed += !far && hit && hit->position.z < target.z - 1e-8;
          // From a little below the surface no way leads to the sky, but over a lying edge of an overhang.
          if (k % 8 != 0) continue;
          glm::dvec3 from = target - glm::dvec3(0, 0, 1e-6 + 1e-3 * depth * uniform(seed, 9));
          if (which == 3) from.z = -depth - 1e-6;
          shadow_leaks += !tracer.occluded(from, wo);
        }
        leaks.rays += kBatch, leaks.nothing_met += nothing, leaks.target_passed += passed,
            leaks.moved += moved;
        leaks.shadow_rays += kBatch / 8, leaks.shadow_leaks += shadow_leaks;
      });
    }
  note("geometry images", leaks);
  record("geometry images: rays 1e5 and 1e6 periods away that meet another point", double(leaks.moved), "0");
  EXPECT_EQ(leaks.moved, 0);
}

// --- the tracer over meshes ---

Tile roughTile(double depth) {
  return importer::testing::heightFieldTile(48, [depth](glm::dvec2 p) {
    const glm::dvec2 q = p - glm::floor(p);
    return bumpHeight(q, depth) * (1 - 0.3 * std::sin(6 * kPi * q.x + 1) * std::sin(2 * kPi * q.y));
  });
}

// Vertex, edge or inside of a triangle, and whether all that is near faces wo, so that what a ray meets there
// is no silhouette that rounding may pass.
struct MeshTarget {
  glm::dvec3 point;
  bool faces;
};

class TileTargets {
 public:
  explicit TileTargets(const Tile& tile) : tile_(tile), around_(tile.positions.size()) {
    for (uint32_t t = 0; t < tile.triangles.size(); ++t)
      for (int k = 0; k < 3; ++k) around_[tile.triangles[t][k]].push_back(t);
    // Vertices at one place, modulo the period, are one vertex.
    std::map<std::tuple<int64_t, int64_t, int64_t>, std::vector<uint32_t>> at;
    for (uint32_t v = 0; v < tile.positions.size(); ++v) at[key(tile.positions[v])].push_back(v);
    for (const auto& [where, vertices] : at) {
      std::vector<uint32_t> all;
      for (const uint32_t v : vertices) all.insert(all.end(), around_[v].begin(), around_[v].end());
      for (const uint32_t v : vertices) around_[v] = all;
    }
  }
  MeshTarget pick(uint64_t seed, const glm::dvec3& wo) const {
    const auto t = static_cast<uint32_t>(mixSeed(seed, 4) % tile_.triangles.size());
    const glm::uvec3 v = tile_.triangles[t];
    const glm::dvec3 &a = tile_.positions[v.x], &b = tile_.positions[v.y], &c = tile_.positions[v.z];
    const double u = uniform(seed, 6), w = uniform(seed, 7);
    const glm::dvec3 inside =
        u + w < 1 ? a + u * (b - a) + w * (c - a) : a + (1 - u) * (b - a) + (1 - w) * (c - a);
    const uint64_t kind = mixSeed(seed, 8) % 3;
    const glm::dvec3 point = kind == 0 ? a : kind == 1 ? glm::mix(a, b, u) : inside;
    bool faces = true;
    const glm::dvec3 along = wo * tile_.perLength();
    for (int k = 0; k < 3; ++k)
      for (const uint32_t near : around_[v[k]]) {
        const glm::uvec3 n = tile_.triangles[near];
        const glm::dvec3 across = glm::cross(tile_.positions[n.y] - tile_.positions[n.x],
                                             tile_.positions[n.z] - tile_.positions[n.x]);
        faces = faces && glm::dot(across, along) > 0.05 * glm::length(across) * glm::length(along);
      }
    return {point, faces};
  }

 private:
  static std::tuple<int64_t, int64_t, int64_t> key(const glm::dvec3& p) {
    const auto wrapped = [](double x) {
      return int64_t(std::llround((x - std::floor(x)) * 1e9)) % 1'000'000'000;
    };
    return {wrapped(p.x), wrapped(p.y), std::llround(p.z * 1e9)};
  }
  const Tile& tile_;
  std::vector<std::vector<uint32_t>> around_;
};

// `rays` of them, in streams of one direction as a bake sends them, and one by one.
void tryTile(const Tile& tile, int64_t rays, double least, Leaks& leaks) {
  const TileTracer tracer(tile);
  const TileTargets targets(tile);
  // Places are floats of one period in the tracer, and rays that are tried again go 2e-6 aside: so much times
  // the slope of what is met, up to 50 times the depth.
  const double slack = 2e-5 - 1e-4 * tracer.zMin();
  constexpr size_t kBatch = 256;
  parallelFor(size_t(rays) / kBatch + 1, 0, [&](size_t batch) {
    const FlushDenormals flush;
    const uint64_t base = mixSeed(17, batch);
    const glm::dvec3 wo = viewOf(base, least);
    const glm::dvec3 along = wo * tile.perLength();
    std::vector<glm::dvec2> x(kBatch);
    std::vector<MeshTarget> aim(kBatch);
    for (size_t k = 0; k < kBatch; ++k) {
      const uint64_t seed = mixSeed(base, 100 + k);
      aim[k] = targets.pick(seed, wo);
      const glm::dvec2 offset = k % 4 == 0 ? offsetOf(seed) : glm::dvec2(0);
      aim[k].point += glm::dvec3(offset, 0);
      x[k] = glm::dvec2(aim[k].point) - glm::dvec2(along) / along.z * aim[k].point.z;
    }
    std::vector<std::optional<TileHit>> hits(kBatch);
    tracer.intersectViews(x, wo, hits);
    int64_t nothing = 0, passed = 0, shadow_leaks = 0, shadows = 0, exact = 0, exact_leaks = 0;
    std::vector<glm::vec3> origins(kBatch);
    for (size_t k = 0; k < kBatch; ++k) {
      const auto alone = k % 16 == 0 ? tracer.intersectView(x[k], wo) : hits[k];
      for (const auto& hit : {hits[k], alone}) {
        nothing += !hit;
        passed += hit && aim[k].faces && hit->position.z < aim[k].point.z - slack;
      }
      origins[k] = glm::vec3(aim[k].point - glm::dvec3(0, 0, 1e-4));
      if (k % 4 == 1 && aim[k].faces)
        ++exact, exact_leaks += !tracer.occluded(aim[k].point - 1e-3 * along, wo);
    }
    // Streams take floats, so offsets of 1e5 have no place in them; single rays take doubles.
    std::vector<uint8_t> wanted(kBatch, 0), blocked(kBatch, 1);
    if (tile.identity_parameterization)
      for (size_t k = 0; k < kBatch; ++k) {
        if (k % 4 == 0)
          ++shadows, shadow_leaks += !tracer.occluded(aim[k].point - glm::dvec3(0, 0, 1e-4), wo);
        else
          ++shadows, wanted[k] = 1;
      }
    tracer.occluded(origins, wanted, glm::vec3(wo), blocked);
    for (size_t k = 0; k < kBatch; ++k) shadow_leaks += !blocked[k];
    leaks.rays += kBatch, leaks.nothing_met += nothing, leaks.target_passed += passed;
    leaks.shadow_rays += shadows, leaks.shadow_leaks += shadow_leaks;
    leaks.vertex_rays += exact, leaks.vertex_leaks += exact_leaks;
  });
}

TEST(StressRays, NoneLeaksThroughMeshes) {
  Leaks leaks;
  const int64_t rays = amount(1'000'000, 100'000'000) / 8;
  for (const double depth : {1e-4, 1e-2, 0.15, 2.0})
    tryTile(roughTile(depth), rays, std::clamp(depth / 20, 1e-3, 0.1), leaks);
  for (const char* name : {"isba", "button", "pulli", "sponge"}) {
    const auto tile = builtinTile(name, 96);
    ASSERT_TRUE(tile.ok());
    tryTile(*tile, rays, 1e-2, leaks);
  }
  note("meshes", leaks);
}

TEST(StressRays, AMeshOfAnySizeIsTheSameTile) {
  const importer::testing::TemporaryFolder folder;
  const auto at = [](glm::dvec2 q) {
    return glm::dvec3(q, bumpHeight(q - glm::floor(q), 0.2)) +
           glm::dvec3(0.05 * std::sin(2 * kPi * q.y), 0, 0);
  };
  std::optional<Tile> reference;
  double worst = 0;
  Leaks leaks;
  for (const double scale : {1.0, 1e-4, 1e-2, 1e2, 1e4}) {
    for (const glm::dvec3& shift : {glm::dvec3(0), glm::dvec3(1e3, -7e2, 3e2)}) {
      const auto path = folder.write(
          "tile.obj",
          importer::testing::objGrid(
              32, [&](glm::dvec2 q) { return scale * (at(q) + shift); }, [](glm::dvec2 q) { return q; }));
      const auto tile = loadTile(path.string());
      ASSERT_TRUE(tile.ok()) << scale << ": " << tile.issue().text;
      if (!reference) reference = *tile;
      ASSERT_EQ(tile->positions.size(), reference->positions.size());
      for (size_t v = 0; v < tile->positions.size(); ++v)
        worst = std::max(worst, largestOf(tile->positions[v] - reference->positions[v]));
      tryTile(*tile, amount(20'000, 1'000'000), 1e-2, leaks);
    }
  }
  record("meshes 1e-4 to 1e4 times as large, 1e3 sizes away: vertices off, tile periods", worst, "<= 1e-6");
  // A file's floats, and 1e3 sizes away 1e3 times their rounding, if they are read as such.
  EXPECT_LE(worst, 1e-6);
  note("meshes of any size", leaks);
}

// Rays that leave a surface do not meet it again: planes and domes have no shadow of their own.
TEST(StressRays, SurfacesDoNotShadowThemselves) {
  int64_t rays = 0, blocked = 0;
  const std::vector<std::function<double(glm::dvec2)>> convex{
      [](glm::dvec2) { return -0.2; },
      // A dome in the middle of a plane, seen from its own upper half.
      [](glm::dvec2 p) { return 0.2 * std::exp(-20 * glm::dot(p - 0.5, p - 0.5)) - 0.2; }};
  for (size_t which = 0; which < convex.size(); ++which) {
    const Tile tile = importer::testing::heightFieldTile(40, convex[which]);
    const TileTracer tracer(tile);
    const int64_t count = amount(200'000, 5'000'000);
    std::atomic<int64_t> dark{0}, tried{0};
    parallelFor(size_t(count / 1000), 0, [&](size_t batch) {
      const FlushDenormals flush;
      int64_t found = 0, used = 0;
      for (uint64_t k = 0; k < 1000; ++k) {
        const uint64_t seed = mixSeed(31 + which, batch * 1000 + k);
        // Within the radius where 20 r^2 < 1/2 the dome bends down in every direction.
        const glm::dvec2 x = which == 0 ? glm::dvec2(uniform(seed, 1), uniform(seed, 2))
                                        : 0.5 + 0.15 * std::sqrt(uniform(seed, 1)) *
                                                    glm::dvec2(std::cos(6.3 * uniform(seed, 2)),
                                                               std::sin(6.3 * uniform(seed, 2)));
        const auto hit = tracer.intersectView(x, {0, 0, 1});
        // The next dome stands .35 away and is .2 high.
        const glm::dvec3 wi =
            cosineDirection({0, 0, 1}, uniform(seed, 3) * (which == 0 ? 0.999 : 0.7), uniform(seed, 4));
        if (!hit || glm::dot(hit->normal, wi) <= 0 || glm::dot(hit->geometric_normal, wi) <= 0) continue;
        ++used, found += tracer.occluded(hit->ray_origin, wi);
      }
      dark += found, tried += used;
    });
    rays += tried, blocked += dark;
  }
  record("rays that leave a plane or a dome towards the light", double(rays), "tried");
  record("rays that leave a plane or a dome towards the light and meet their own surface", double(blocked),
         "0");
  EXPECT_EQ(blocked, 0);
}

}  // namespace
}  // namespace loden::stress
