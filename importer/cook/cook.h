// Cooks a baked output into a material: the fits of both papers and their combination.
#pragma once

#include <optional>
#include <string>

#include "importer/btf/baked_output.h"
#include "importer/btf/btf_source.h"
#include "material/base/result.h"
#include "material/model/material.h"

namespace loden::importer {

enum class Preset { kSeed, kGame, kReference };

// How mode fused shows the surface up close.
enum class Near {
  kSurface,  // the near term: computed from the surface's reflectance and visibility of the light
  kBand,     // a flat-domain band that is fitted to the BTF, as is needed where the reflectance is not known
};

struct CookOptions {
  Mode mode = Mode::kFused;
  Preset preset = Preset::kGame;
  // Numbers of components; all 0: the preset's.
  int y_components = 0, cb_components = 0, cr_components = 0;
  Near near = Near::kSurface;
  // Visibility of the near term; empty: the one that measures best, kNone in mode surface.
  std::optional<Visibility> visibility = {};
  int levels = 0;          // levels of detail; 0: the preset's
  uint64_t max_bytes = 0;  // goal: most bytes of all raw data in the file; 0: none
  double target_rmse = 0;  // goal: RMSE of Y, white = 1; 0: none
  int threads = 0;
  bool quiet = false;
};

// Cooks a baked output. Deterministic at any number of threads. Issues: kOption, also for options that the
// mode would ignore.
Result<Material> cook(const BakedOutput& input, const CookOptions& options);
// Cooks a BTF without meso-geometry, for example a measured one; mode lod only.
Result<Material> cook(const BtfSource& input, const CookOptions& options);

}  // namespace loden::importer
