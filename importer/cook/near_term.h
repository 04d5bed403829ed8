// Makes the maps of the near term (material/model/surface_maps.h) from baked surface maps and geometry.
#pragma once

#include "importer/btf/baked_output.h"
#include "material/model/material.h"

namespace loden::importer {

// The surface of a baked output: its maps, and texels per side of them.
struct BakedSurface {
  BakedOutput::Surface maps;
  int side = 0;
  int bounces = 0;  // BakeManifest::bounces of the BTF
};
Result<BakedSurface> bakedSurface(const BakedOutput& input);

struct NearOptions {
  int reduced = 1;          // divisor of every map's side, a power of two
  bool with_bands = false;  // maps end where bands take over, at kNearFadeEnd; otherwise at one texel
  Visibility visibility = Visibility::kNone;  // kMap: makes a shadow map
  // Above 0: makes the map of light that the tile reflects so many times, if there is geometry.
  int bounces = 0;
};

// By how many levels near maps are read finer than the level that is shown. A mean over a texel's surface is
// not the mean of what a view sees of it. One level finer, the error at lambda 1.5 is a third to a half of
// that at the level itself (on all four tiles, tests/studies/RESULTS.md). Two levels finer gains no more.
inline constexpr float kNearFiner = 1;

// The latest window in which bands take over from the near term; importer/cook/level_choice.h measures the
// one of an asset.
inline constexpr float kNearFadeBegin = 0.5f, kNearFadeEnd = 3;

// The near term's maps. `side`: reference texels per side. Mips are averages inside one chart. A lobe is
// wider where the normals of a texel differ (Toksvig 2004 for Phong; for GGX alpha^2 grows by twice their
// variance). The ambient map is traced on the geometry image; without one it is that of a plane.
// Deterministic at any number of threads.
SurfaceMaps nearMaps(const BakedSurface& baked, const GeometryImage& geometry, int side,
                     const NearOptions& options, int threads);

// The components of the shadow map, and the directions per side of its table.
inline constexpr int kShadowComponents = 8, kShadowTable = 13;

// The raw bytes of these maps; `shadow`: including the shadow map, `indirect`: including the map of indirect
// light.
uint64_t nearBytes(int surface_side, int side, bool with_bands, bool shadow, bool indirect);

}  // namespace loden::importer
