// Writes Material::meta_json: how an asset was cooked and what error was measured.
#pragma once

#include <span>
#include <string>

#include "importer/cook/atlas_choice.h"
#include "importer/cook/cook.h"
#include "importer/cook/goal.h"
#include "importer/fit/measure.h"

namespace loden::importer {

const char* presetName(Preset preset);

// The raw bytes of everything in the file, before compression.
uint64_t rawFileBytes(const Material& material);
// The bytes that are resident when the material is drawn at lambda 0 with its own atlas.
uint64_t residentBytes(const Material& material);

// The text, which is the JSON object
//   {"mode", "preset", "components": "8,2,2", "input" (without its folder), "coefficient_bytes", "raw_bytes",
//    "gpu_bytes",
//    "error": {"y": {"rmse", "mse", "mae"}, "cb": ..., "cr": ...},
//    "lookup": {"geometry_side", "atlas_texels", "atlas_directions", "bytes", "fast": {"mean_texels",
//               "over_1_texel", "fetches"}, "default": ..., "tried": [{"texels", "directions", "mean_texels",
//               "over_1_texel", "fetches"}]},
//    "trade": [{"y_components", "phis", "flat_scale", "bits", "geometry_side", "bytes", "rmse_y", "pareto"}]}
// "lookup" (importer/fit/lookup_error.h) is there if the material has geometry that is looked up; its "tried"
// lists `atlases` for the default look-up. `error` may be null. `trade` holds the plans that a goal measured.
// A material with a near term also has "near": {"lobe", "visibility", "side", "bytes"}. From `fit` "error"
// gets "lab" and "evaluations", and "error_of_one_evaluation" has the members of "error" for one evaluation
// per texel.
std::string cookMeta(const Material& material, const std::string& input, const std::string& preset,
                     const BtfError* error, const std::vector<TradePoint>& trade = {},
                     std::span<const AtlasTrial> atlases = {}, const FusedFit* fit = nullptr);

}  // namespace loden::importer
