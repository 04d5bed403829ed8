// The plan of a fused asset: the choices that trade bytes for error.
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
  // Texels per side of the near term's maps: those of the baked maps or these divided by a power of two. 0:
  // no near term, but a flat-domain band, which the fields marked "flat-domain band" describe.
  int surface_side = 0;
  // Visibility of the near term; empty: the one that measures best.
  std::optional<Visibility> visibility = {};
  // Above 0: the near term includes light that the tile reflects so many times, if that brings it closer to
  // the BTF.
  int bounces = 0;
  int y_components = 20;  // flat-domain band: Y components
  // Flat-domain band: components of Cb and of Cr each, for the part of the chroma that a ratio to Y does not
  // give, such as highlights without the surface's colour.
  int chroma_components = 0;
  Storage storage = Storage::kSnorm8;  // flat-domain band: how it is stored
  double flat_scale = 1;  // flat-domain band: flat texels per reference texel along one side; 1/2, 1, 2
  int phis = 11;          // flat-domain band: columns of the direction grid, including the repeated one
  // Y components of the reference-domain band; 0: no such band (nothing at lambda 0 reads it).
  int coarse_y = 20;
  // Reference-domain band: Cb and Cr components each, for what a ratio to Y does not give, such as metal and
  // coloured cloth in one texel. Empty, with a near term: as many quads hold chroma in place of Y as bring
  // what is shown closest (chooseLevels); without one: none.
  std::optional<int> coarse_chroma = {};
  int coarse_phis = 18;  // reference-domain band: most columns of the direction grid; see averageGrid
  // Number of finest levels to keep: 1 is the flat-domain band alone; 0: all, down to the full average.
  int levels = 0;
  int geometry_side = 0;  // texels per side of the geometry image; 0: as baked
  int sweeps = 6;         // sweeps of the joint fit of the flat-domain band
  // Size of the VDIM atlas of the look-up through which bands are fitted; empty: chosen by measuring
  // (importer/cook/atlas_choice.h).
  std::optional<VdimAtlasSize> atlas = {};
};

// The flat texels along one side, for `side` reference texels.
int flatSide(const FusedPlan& plan, int side);

// RMSE of Y at lambda 0 with light that arrives by way of the tile, and without it. The light is kept if the
// RMSE is less with it.
struct IndirectTrial {
  double with = 0, without = 0;
};

// What is shown at lambda 1 to 3 with so many quads of the coarse band for chroma in place of Y.
struct ChromaTrial {
  int chroma_quads = 0;
  double rmse_rgb = 0;  // shownRmse
  bool closer = true;   // clearly, than with one quad less; the last that is closer is kept
};

struct FusedFit {
  Material material;
  // The error at lambda 0 and the sampled directions through the shader's default look-up. With a near term
  // it is that of random samples, as the mean of four evaluations per texel.
  BtfError error;
  // With a near term: the error of four evaluations per texel, and of one.
  std::optional<SampledError> near, near_at_centres;
  std::optional<IndirectTrial> indirect;  // if the plan has bounces
  std::vector<LevelTrial> levels;         // the measurements by which it was chosen what shows each level
  std::vector<ChromaTrial> chroma;  // the numbers of chroma quads that were measured, if the plan names none
  std::vector<AtlasTrial> atlases;  // the atlases that were measured, if the plan names none
};

// Fit plans without and with a near term. `geometry` is already at plan.geometry_side. Deterministic at any
// number of threads. `lab_every` is that of measureError. `progress` advances by kFusedSteps at most.
inline constexpr uint64_t kFusedSteps = 13;
FusedFit fitFusedBands(const BtfSource& source, const YccBtf& btf, const GeometryImage& geometry,
                       const FusedPlan& plan, int threads, int lab_every = 0, Progress* progress = nullptr);
FusedFit fitFusedNear(const BtfSource& source, const HalvedBtf& btf, const BakedSurface& surface,
                      const GeometryImage& geometry, const FusedPlan& plan, int threads,
                      Progress* progress = nullptr);

// The most raw bytes that the file of a plan holds, computed without fitting it; exact if coarse_phis is the
// number that averageGrid chooses.
uint64_t fusedBytes(const FusedPlan& plan, int side, int geometry_side);

}  // namespace loden::importer
