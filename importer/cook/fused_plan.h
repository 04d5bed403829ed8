// What a fused asset is made of: the choices that trade bytes for error.
#pragma once

#include <optional>
#include <vector>

#include "importer/base/progress.h"
#include "importer/cook/atlas_choice.h"
#include "importer/cook/level_choice.h"
#include "importer/cook/near_term.h"
#include "importer/fit/band_pack.h"
#include "importer/fit/indirection.h"
#include "importer/fit/measure.h"
#include "importer/fit/sampled_error.h"
#include "material/model/material.h"

namespace loden::importer {

struct FusedPlan {
  // Texels per side of the near term's maps, those of the baked ones or a 2^n-th; 0: no near term, but a
  // flat-domain band, which the next fields up to `phis` describe.
  int surface_side = 0;
  std::optional<Visibility> visibility = {};  // of the near term; empty: what measures best
  int bounces =
      0;  // above 0: the near term has light that the tile reflects so often, where it is closer by it
  int y_components = 20;  // of the flat-domain band
  int chroma_components =
      0;  // of Cb and of Cr each, for what a ratio to Y leaves: highlights without the surface's colour
  Storage storage = Storage::kSnorm8;  // of the flat-domain band
  double flat_scale = 1;               // flat texels per reference texel, along one side; 1/2, 1, 2
  int phis = 11;                       // columns of its direction grid, the repeated one counted
  int coarse_y = 20;     // of the reference-domain band; 0: leave it out (nothing at lambda 0 reads it)
  int coarse_phis = 18;  // at most; see averageGrid
  int levels = 0;  // finest levels to keep: 1 is the flat-domain band alone; 0: all, down to the full average
  int geometry_side = 0;  // of the geometry image; 0: as baked
  int sweeps = 6;         // of the joint fit
  std::optional<VdimAtlasSize> atlas =
      {};  // of the lookup that is fitted through; empty: chosen by measuring (atlas_choice.h)
};

// Flat texels along one side, for a reference side.
int flatSide(const FusedPlan& plan, int side);

// RMSE of Y at lambda 0 with light that comes by way of the tile, and without; it is kept where that is less.
struct IndirectTrial {
  double with = 0, without = 0;
};

struct FusedFit {
  Material material;
  // At lambda 0 and sampled directions through the shader's default lookup; with a near term at random ones
  // of these, of the mean of four evaluations a texel.
  BtfError error;
  std::optional<SampledError> near, near_at_centres;  // with a near term: of four evaluations, and of one
  std::optional<IndirectTrial> indirect;              // where the plan has bounces
  std::vector<LevelTrial> levels;                     // that what each level is shown by was chosen by
  std::vector<AtlasTrial> atlases;                    // that were measured, if the plan names none
};

// `geometry` is already at plan.geometry_side; `surface` is there if the plan has a near term. Deterministic
// at any number of threads. lab_every: as in measureError. The progress advances by kFusedSteps in all.
inline constexpr uint64_t kFusedSteps = 13;
FusedFit fitFused(const BtfSource& source, const YccBtf& btf, const GeometryImage& geometry,
                  const FusedPlan& plan, int threads, int lab_every = 0,
                  const BakedSurface* surface = nullptr, Progress* progress = nullptr);

// Raw bytes that the file of a plan holds at most, without fitting it; exact for coarse_phis as chosen.
uint64_t fusedBytes(const FusedPlan& plan, int side, int geometry_side);

}  // namespace loden::importer
