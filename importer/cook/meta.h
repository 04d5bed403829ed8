// Material::meta_json: how an asset was cooked and what error was measured.
#pragma once

#include <span>
#include <string>

#include "importer/cook/atlas_choice.h"
#include "importer/cook/cook.h"
#include "importer/cook/goal.h"
#include "importer/fit/measure.h"

namespace loden::importer {

const char* presetName(Preset preset);

// Raw bytes of everything the file holds, before compression.
uint64_t rawFileBytes(const Material& material);
// Bytes resident when drawn at lambda 0 with the material's own atlas.
uint64_t residentBytes(const Material& material);

// {"mode", "preset", "components": "8,2,2", "input" (without its folder), "coefficient_bytes", "raw_bytes",
// "gpu_bytes",
//  "error": {"y": {"rmse", "mse", "mae"}, "cb": ..., "cr": ...},
//  "lookup": {"geometry_side", "atlas_texels", "atlas_directions", "bytes", "fast": {"mean_texels",
//  "over_1_texel", "fetches"}, "default": ..., "tried": [{"texels", "directions", "mean_texels",
//  "over_1_texel", "fetches"}]}
// (lookup_error.h) where the material has geometry that is looked up; `tried` lists `atlases`, default
// lookup,
//  "trade": [{"y_components", "phis", "flat_scale", "bits", "geometry_side", "bytes", "rmse_y", "pareto"}]};
// `error` may be null, `trade` holds what a goal measured on its way. With a near term "near": {"lobe",
// "visibility", "side", "bytes"}, and of `fit` "error" has "lab" and "evaluations", and
// "error_of_one_evaluation" is the same of one evaluation a texel.
std::string cookMeta(const Material& material, const std::string& input, const std::string& preset,
                     const BtfError* error, const std::vector<TradePoint>& trade = {},
                     std::span<const AtlasTrial> atlases = {}, const FusedFit* fit = nullptr);

}  // namespace loden::importer
