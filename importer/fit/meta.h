// Material::meta_json: how an asset was cooked and what error was measured.
#pragma once

#include <string>

#include "importer/cook.h"
#include "importer/fit/goal.h"
#include "importer/fit/measure.h"

namespace loden::importer {

const char* presetName(Preset preset);

// Raw bytes of everything the file holds, before compression.
uint64_t rawFileBytes(const Material& material);
// Bytes resident when drawn at lambda 0 with an atlas of this size.
uint64_t residentBytes(const Material& material, const VdimAtlasSize& atlas);

// {"mode", "preset", "components": "8,2,2", "input" (without its folder), "coefficient_bytes", "raw_bytes", "gpu_bytes",
//  "error": {"y": {"rmse", "mse", "mae"}, "cb": ..., "cr": ...},
//  "lookup": {"geometry_side", "atlas_texels", "atlas_directions", "bytes", "fast": {"mean_texels", "over_1_texel",
//  "fetches"}, "default": ...} (lookup_error.h) where the material has geometry that is looked up,
//  "trade": [{"y_components", "phis", "flat_scale", "bits", "geometry_side", "bytes", "rmse_y", "pareto"}]}; `error` may be
// null, `trade` holds what a goal measured on its way.
std::string cookMeta(const Material& material, const std::string& input, const std::string& preset,
                     const BtfError* error, const std::vector<TradePoint>& trade = {});

}  // namespace loden::importer
