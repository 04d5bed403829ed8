// The maps of the near term (material/model/material.h: SurfaceMaps) from baked surface maps and geometry.
#pragma once

#include "importer/btf/baked_output.h"
#include "material/model/material.h"

namespace loden::importer {

// The surface of a baked output: its maps, their side, and the reference texels per side.
struct BakedSurface {
  BakedOutput::Surface maps;
  int side = 0;
  int bounces = 0;  // of the light that the BTF was baked with
};
Result<BakedSurface> bakedSurface(const BakedOutput& input);

struct NearOptions {
  int reduced = 1;          // every side by this, a power of two
  bool with_bands = false;  // maps end where bands take over, at kNearFadeEnd; else at one texel
  Visibility visibility = Visibility::kNone;  // kMap: with a shadow map
  int bounces = 0;  // above 0: with the map of light that the tile reflects so often, if there is geometry
};

// Near maps are read one level finer than what is shown: a mean over a texel's surface is not the mean of
// what a view sees of it, and one level finer it is a third to a half as far off at lambda 1.5 (all four
// tiles, tests/studies/RESULTS.md). Two levels finer gains no more.
inline constexpr float kNearFiner = 1;

// At the latest, bands have taken over here (fade_choice.h).
inline constexpr float kNearFadeBegin = 0.5f, kNearFadeEnd = 3;

// `side`: reference texels per side. Mips are averages inside one chart; a lobe is wider where the normals of
// a texel differ (Toksvig 2004 for Phong; for GGX alpha^2 grows by twice their variance). The ambient map is
// traced on the geometry image, or without one holds what a plane would. Deterministic at any number of
// threads.
SurfaceMaps nearMaps(const BakedSurface& baked, const GeometryImage& geometry, int side,
                     const NearOptions& options, int threads);

// Components of the shadow map, and directions per side of its table.
inline constexpr int kShadowComponents = 8, kShadowTable = 13;

// Raw bytes of these maps; `shadow`: with the shadow map, `indirect`: with that of indirect light.
uint64_t nearBytes(int surface_side, int side, bool with_bands, bool shadow, bool indirect);

}  // namespace loden::importer
