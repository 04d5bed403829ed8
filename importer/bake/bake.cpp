#include "importer/bake/bake.h"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <chrono>
#include <cstdio>
#include <functional>

#include "importer/bake/bake_folder.h"
#include "importer/bake/bake_scene.h"
#include "importer/bake/geometry_side.h"
#include "importer/bake/surface_samples.h"
#include "importer/bake/view_fill.h"
#include "importer/base/parallel.h"
#include "importer/base/progress.h"
#include "importer/base/random.h"
#include "importer/mesh/parameterize.h"
#include "importer/tile/charts.h"
#include "importer/tile/mesh_material.h"
#include "material/base/issues.h"

namespace loden::importer {
namespace {

namespace fs = std::filesystem;

// More misses than this share of the view rays mean a hole in the tile.
constexpr double kMaxMissRate = 1e-3;

Status checkOptions(const BakeOptions& o) {
  const auto refuse = [](const std::string& field, const std::string& why) {
    return Issue{issue_id::kOption, Severity::kError, field, why};
  };
  for (const int side : {o.size, o.flat_size, o.surface_size, o.geometry_size})
    if (side < 0 || side > 4096) return refuse("size", "must be 1 to 4096 texels");
  if (o.size < 1) return refuse("size", "must be 1 to 4096 texels");
  if (o.supersample < 1 || o.supersample > 16)
    return refuse("supersample", "must be 1 to 16 samples per side");
  if (o.bounces < 0 || o.bounces > 16) return refuse("bounces", "must be 0 to 16");
  if (o.shards < 1 || o.shard < 0 || o.shard >= o.shards)
    return refuse("shard", "must be I/N with 0 <= I < N");
  for (const glm::ivec2& v : o.vdims)
    if (v.x < 2 || v.y < 2 || v.x > kMaxVdimSide || v.y > kMaxVdimSide)
      return refuse("vdims", "a latlong map has 2 to 256 zeniths and azimuths");
  for (const int side : o.concentric_vdims)
    if (side < 1 || side > kMaxVdimSide)
      return refuse("vdims", "a concentric map has 1 to 256 directions per side");
  return {};
}

// Texels per side of maps over p whose filters keep the charts apart, and of which none is overlapped by two:
// a gutter of two texels, as nearly as gutterOf can tell. 0 where there is one chart.
int texelsForGutters(const Tile& tile) {
  if (std::all_of(tile.charts.begin(), tile.charts.end(), [](uint16_t chart) { return chart == 1; }))
    return 0;
  const double gutter = gutterOf(tile) + 1.0 / 256;  // half of what gutterOf may have cut off
  return static_cast<int>(std::ceil(2 / gutter));
}

// Of sizes that were asked for; others are chosen large enough.
Status checkGutters(const BakeOptions& o, int needed) {
  std::string small;
  for (const auto& [field, side] : {std::pair{"flat_size", o.flat_size},
                                    {"surface_size", o.surface_size},
                                    {"geometry_size", o.geometry_size}}) {
    if (side == 0 || side >= needed) continue;
    if (!small.empty()) small += ", ";
    small += field;
  }
  if (small.empty()) return {};
  return Issue{issue_id::kOption, Severity::kError, small,
               "the tile has several charts, and the gutters between them need at least " +
                   std::to_string(needed) + " texels per side; left out, a large enough size is chosen"};
}

// `needed` as texelsForGutters.
BakeManifest manifestOf(const Tile& tile, const std::string& tile_name, const BakeOptions& o, int needed) {
  BakeManifest m;
  m.tile = tile_name;
  m.input_hash = tileHash(tile);
  m.aspect = tile.aspect, m.period = o.period;
  m.size = o.size;
  m.flat_size = o.flat_size > 0 ? o.flat_size : std::max(o.size, needed);
  m.surface_size = o.surface_size > 0 ? o.surface_size : std::max(std::min(2 * o.size, 4096), needed);
  m.geometry_size =
      o.geometry_size > 0 ? o.geometry_size : geometrySideOf(tile, std::max({128, o.size, needed}));
  m.supersample = o.supersample;
  m.bounces = o.bounces;
  m.fill = o.fill;
  m.texels = o.texels;
  m.directions = o.directions.size() > 0 ? o.directions : bonn81Directions();
  if (o.maps.vdim) m.vdims = o.vdims, m.concentric_vdims = o.concentric_vdims;
  m.has_btf = o.maps.btf, m.has_flat = o.maps.flat, m.has_vdim = o.maps.vdim, m.has_surface = o.maps.surface;
  m.has_ggx = hasGgx(tile);
  m.identity_parameterization = tile.identity_parameterization;
  const ParameterizationQuality quality =
      measureParameterization(tile.positions, tile.params, tile.triangles);
  m.flipped_triangles = quality.flipped;
  m.area_cv = quality.area_cv, m.area_p5 = quality.area_p5, m.area_p95 = quality.area_p95;
  return m;
}

// Asked before anything is written, and of the tile and its directions alone: every shard and every resumed
// run gets the same answer.
Status checkCovers(const TileTracer& tracer, const BakeManifest& m, const std::string& tile_name) {
  constexpr int kSide = 32;  // rays of a view, per side
  constexpr size_t kMostViews = 100;
  const FlushDenormals flush;
  const auto& views = m.directions.samples;
  const size_t count = std::min(views.size(), kMostViews);
  uint64_t misses = 0;
  glm::dvec2 first_x(0), first_view(0);
  for (size_t k = 0; k < count; ++k) {
    const glm::dvec3& wo = views[k * views.size() / count];
    for (int t = 0; t < kSide * kSide; ++t) {
      const uint64_t seed = mixSeed(k, uint64_t(t));
      const glm::dvec2 x =
          (glm::dvec2(t % kSide, t / kSide) + glm::dvec2(uniform(seed, 0), uniform(seed, 1))) / double(kSide);
      if (tracer.intersectView(x, wo) || misses++ > 0) continue;
      const Spherical view = sphericalFromDirection(wo);
      first_x = x, first_view = glm::degrees(glm::dvec2(view.theta, view.phi));
    }
  }
  const uint64_t rays = count * kSide * kSide;
  if (double(misses) <= kMaxMissRate * double(rays)) return {};
  char place[120];
  std::snprintf(place, sizeof place, ", the first at x = (%.3f, %.3f) from theta %.0f, phi %.0f degrees",
                first_x.x, first_x.y, first_view.x, first_view.y);
  return Issue{issue_id::kTileGeometry, Severity::kError, tile_name,
               std::to_string(misses) + " of " + std::to_string(rays) + " view rays meet no surface" + place +
                   ": the tile has holes or does not cover its period; close them, or put a ground under "
                   "them by --ground D"};
}

// One file or group of files of the output; the unit of sharding and resuming.
struct Item {
  std::vector<fs::path> files;
  std::function<Status()> make;
};

bool present(const Item& item) {
  std::error_code error;
  return std::all_of(item.files.begin(), item.files.end(),
                     [&](const fs::path& file) { return fs::exists(file, error); });
}

// What a resumed bake keeps: files that are there and can be decoded, since a full disk or a power cut may
// have left damaged ones behind.
bool isWhole(const Item& item) {
  return std::all_of(item.files.begin(), item.files.end(),
                     [](const fs::path& file) { return readImage(file).ok(); });
}

Status write(const fs::path& path, const Image& image, PixelType type) {
  return writeImage(path, image.width, image.height, image.channels, type, image.pixels);
}

// The whole bake as a list of items, in a fixed order: item k belongs to shard k mod shards.
class BakeItems {
 public:
  BakeItems(const BakeScene& scene, const fs::path& folder) : scene_(scene), folder_(folder) {
    const BakeManifest& m = scene.manifest;
    for (int view = 0; view < m.directions.size(); ++view) addView(view);
    for (const glm::ivec2& size : m.vdims)
      items_.push_back({{vdimPath(folder, size)}, [this, size] {
                          return write(vdimPath(folder_, size), bakeVdim(scene_, size), PixelType::kFloat);
                        }});
    for (const int side : m.concentric_vdims)
      items_.push_back({{concentricVdimPath(folder, side)}, [this, side] {
                          return write(concentricVdimPath(folder_, side), bakeConcentricVdim(scene_, side),
                                       PixelType::kFloat);
                        }});
    if (m.has_surface) addSurface();
  }
  const std::vector<Item>& items() const { return items_; }

 private:
  void addView(int view);
  void addSurface();
  const SurfaceSamples& surface() {  // made when the first view needs it
    if (!surface_) surface_.emplace(scene_);
    return *surface_;
  }

  const BakeScene& scene_;
  const fs::path folder_;
  std::optional<SurfaceSamples> surface_;
  std::vector<Item> items_;
};

void BakeItems::addView(int view) {
  const BakeManifest& m = scene_.manifest;
  Item item;
  if (m.has_btf) item.files.push_back(btfPath(folder_, view));
  if (m.has_flat)
    item.files.push_back(flatPath(folder_, view)), item.files.push_back(visiblePath(folder_, view));
  item.make = [this, view, &m]() -> Status {
    if (m.has_btf)
      if (Status status =
              write(btfPath(folder_, view), bakeBtfView(scene_, surface(), view), PixelType::kHalf);
          !status)
        return status;
    if (!m.has_flat) return {};
    const FlatView result = bakeFlatView(scene_, surface(), view);
    if (Status status = write(flatPath(folder_, view), result.atlas, PixelType::kHalf); !status)
      return status;
    return writeImage(visiblePath(folder_, view), m.flat_size, m.flat_size, 1, PixelType::kByte,
                      result.visible);
  };
  items_.push_back(std::move(item));
}

void BakeItems::addSurface() {
  Item item;
  for (const char* map : {"geometry", "normal", "diffuse", "specular"})
    item.files.push_back(surfacePath(folder_, map));
  if (scene_.manifest.has_ggx) item.files.push_back(surfacePath(folder_, "ggx"));
  item.make = [this, files = item.files]() -> Status {
    const SurfaceImages images = bakeSurface(scene_);
    const Image* const maps[] = {&images.geometry, &images.normal, &images.diffuse, &images.specular,
                                 &images.ggx};
    for (size_t k = 0; k < files.size(); ++k)
      if (Status status = write(files[k], *maps[k], PixelType::kFloat); !status) return status;
    return {};
  };
  items_.push_back(std::move(item));
}

Status makeItems(const std::vector<Item>& items, const BakeOptions& options, const std::string& tile_name,
                 const BakeCounters& counters) {
  const auto start = std::chrono::steady_clock::now();
  std::vector<const Item*> due;
  for (size_t k = 0; k < items.size(); ++k)
    if (int(k % size_t(options.shards)) == options.shard && !(options.resume && isWhole(items[k])))
      due.push_back(&items[k]);
  Progress progress("bake " + tile_name, due.size(), options.quiet);
  for (const Item* item : due) {
    if (Status status = item->make(); !status) return status;
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    char note[32];
    std::snprintf(note, sizeof note, "%.1f Mray/s", double(counters.rays) / seconds / 1e6);
    progress.advance(1, note);
  }
  return {};
}

}  // namespace

Result<BakeReport> bake(const Tile& tile, const std::string& tile_name, const fs::path& folder,
                        const BakeOptions& options) {
  if (const Status status = checkOptions(options); !status) return status.issue();
  const auto start = std::chrono::steady_clock::now();
  const int needed = texelsForGutters(tile);
  if (const Status status = checkGutters(options, needed); !status) return status.issue();
  const BakeManifest manifest = manifestOf(tile, tile_name, options, needed);
  const TileTracer tracer(tile);
  if (const Status status = checkCovers(tracer, manifest, tile_name); !status) return status.issue();
  const auto ready = BakeFolder::prepare(folder, manifest, options.resume, options.shards > 1);
  if (!ready) return ready.issue();

  BakeCounters counters;
  const BakeScene scene{tracer, manifest, counters};
  BakeItems items(scene, folder);
  const int threads = usableThreads(options.threads);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, size_t(threads));
  tbb::task_arena arena(threads);
  const Status made = arena.execute([&] { return makeItems(items.items(), options, tile_name, counters); });
  if (!made) return made.issue();
  const bool complete = std::all_of(items.items().begin(), items.items().end(), present);
  if (complete) {
    const auto fill = [&] {
      return arena.execute([&] { return fillFromViews(folder, manifest, options.quiet); });
    };
    if (const Status status = ready->finish(fill); !status) return status.issue();
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return BakeReport{manifest, complete, counters.rays, seconds, counters.misses};
}

}  // namespace loden::importer
