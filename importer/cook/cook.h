// From a baked output to a material: the fits of both papers and their combination.
#pragma once

#include <optional>
#include <string>

#include "importer/btf/baked_output.h"
#include "importer/btf/btf_source.h"
#include "material/base/result.h"
#include "material/model/material.h"

namespace loden::importer {

enum class Preset { kSeed, kGame, kReference };

// What shows up close, in mode fused.
enum class Near {
  kSurface,  // what is known of the surface: its reflectance and who sees the light (the near term)
  kBand,     // a flat-domain band that is fitted to the BTF, as where the reflectance is not known
};

struct CookOptions {
  Mode mode = Mode::kFused;
  Preset preset = Preset::kGame;
  int y_components = 0, cb_components = 0, cr_components = 0;  // all 0: the preset's
  Near near = Near::kSurface;
  std::optional<Visibility> visibility = {};  // of the near term; empty: what measures best, kNone in mode
                                              // surface
  int levels = 0;                             // 0: the preset's
  uint64_t max_bytes = 0;                     // goal; 0: none. Bytes of all raw data in the file
  double target_rmse = 0;                     // goal on Y, white = 1; 0: none
  int threads = 0;
  bool quiet = false;
};

// Deterministic at any number of threads. Options that the mode would ignore are refused (kOption).
Result<Material> cook(const BakedOutput& input, const CookOptions& options);
// A BTF without meso-geometry, for example a measured one: mode lod only.
Result<Material> cook(const BtfSource& input, const CookOptions& options);

}  // namespace loden::importer
