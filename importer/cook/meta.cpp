#include "importer/cook/meta.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "importer/fit/lookup_error.h"
#include "material/model/environment.h"
#include "material/model/leading_part.h"
#include "material/model/maps.h"
#include "material/system/threads.h"

namespace loden::importer {

const char* presetName(Preset preset) {
  switch (preset) {
    case Preset::kSeed:
      return "seed";
    case Preset::kGame:
      return "game";
    case Preset::kReference:
      return "reference";
  }
  return "unknown";
}

namespace {

uint64_t bandBytes(const Material& material) {
  uint64_t bytes = 0;
  for (const Band& band : material.bands) bytes += band.bytes();
  return bytes;
}

// Components of the finest band: "16,0,0" where chroma is a ratio.
std::string componentsText(const Material& material) {
  if (material.bands.empty()) return "0,0,0";
  const Band& band = material.bands.front();
  const std::string chroma = std::to_string(2 * band.chroma_quads);
  return std::to_string(4 * band.y_quads) + "," + chroma + "," + chroma;
}

nlohmann::ordered_json errorJson(const LookupError& e) {
  return {{"mean_texels", e.mean_texels}, {"over_1_texel", e.over_1_texel}, {"fetches", e.fetches}};
}

nlohmann::ordered_json lookupMeta(const Material& material, std::span<const AtlasTrial> tried) {
  const VdimAtlas atlas = buildVdimAtlas(material.geometry, material.atlas, onThreads());
  const LookupProbe probe(material.geometry, material.side, 0);
  nlohmann::ordered_json json = {{"geometry_side", material.geometry.side()},
                                 {"atlas_texels", atlas.size.texels},
                                 {"atlas_directions", atlas.size.directions},
                                 {"bytes", atlas.bytes()}};
  for (const Lookup lookup : {Lookup::kFast, Lookup::kDefault})
    json[std::string(lookupName(lookup))] = errorJson(probe.measure(atlas, lookup));
  for (const AtlasTrial& trial : tried) {
    nlohmann::ordered_json of_trial = {{"texels", trial.size.texels}, {"directions", trial.size.directions}};
    of_trial.update(errorJson(trial.error));
    json["tried"].push_back(std::move(of_trial));
  }
  return json;
}

// Without its folder: where an input lies must not change an asset's bytes.
std::string inputName(const std::string& input) {
  const std::filesystem::path path(input);
  return (path.has_filename() ? path : path.parent_path()).filename().string();
}

}  // namespace

uint64_t rawFileBytes(const Material& material) {
  uint64_t bytes = 0;
  for (const MaterialPart& part : materialParts(material)) bytes += mapBytes(material, part);
  return bytes;
}

uint64_t residentBytes(const Material& material) {
  uint64_t bytes = rawFileBytes(material) + leadingPartBytes(material);
  for (const Band& band : material.bands) bytes += environmentTableBytes(band);  // made by the runtime
  if (material.geometry.empty() || material.mode == Mode::kLod) return bytes;
  // The atlas holds a packed copy of the geometry, which itself does not go to the GPU.
  return bytes - material.geometry.texels.data.size() + residentAtlasBytes(material.geometry, material.atlas);
}

std::string cookMeta(const Material& material, const std::string& input, const std::string& preset,
                     const BtfError* error, const std::vector<TradePoint>& trade,
                     std::span<const AtlasTrial> atlases, const FusedFit* fit) {
  nlohmann::ordered_json meta = {{"mode", modeName(material.mode)},
                                 {"preset", preset},
                                 {"input", inputName(input)},
                                 {"components", componentsText(material)},
                                 {"coefficient_bytes", bandBytes(material)},
                                 {"raw_bytes", rawFileBytes(material)},
                                 {"gpu_bytes", residentBytes(material)}};
  if (error) {
    const auto channels = [](const FitError(&channel)[3]) {
      nlohmann::ordered_json json;
      const char* names[3] = {"y", "cb", "cr"};
      for (int c = 0; c < 3; ++c)
        json[names[c]] = {{"rmse", channel[c].rmse()}, {"mse", channel[c].mse}, {"mae", channel[c].mae}};
      return json;
    };
    meta["error"] = channels(error->channel);
    if (fit && fit->near) {
      meta["error"]["lab"] = fit->near->lab;
      meta["error"]["evaluations"] = 4;
      meta["error_of_one_evaluation"] = channels(fit->near_at_centres->channel);
      meta["error_of_one_evaluation"]["lab"] = fit->near_at_centres->lab;
    }
  }
  if (material.surface) {
    const SurfaceMaps& maps = *material.surface;
    meta["near"] = {{"lobe", maps.lobe == Lobe::kGgx ? "ggx" : "phong"},
                    {"visibility", visibilityName(maps.visibility)},
                    {"side", maps.color.width},
                    {"bytes", mapBytes(material, {PartKind::kSurface})}};
    if (maps.indirect.width > 0) meta["near"]["indirect"] = true;
    if (fit && fit->indirect)
      meta["near"]["indirect_rmse_y"] = {{"with", fit->indirect->with}, {"without", fit->indirect->without}};
    if (fit && !fit->levels.empty()) meta["near"]["fade"] = {maps.fade_begin, maps.fade_end};
    if (fit)
      for (const ChromaTrial& trial : fit->chroma)
        meta["chroma"].push_back(
            {{"quads", trial.chroma_quads}, {"rmse_rgb", trial.rmse_rgb}, {"kept", trial.closer}});
  }
  if (fit)
    for (const LevelTrial& trial : fit->levels) {
      nlohmann::ordered_json of_level = {{"level", trial.level}};
      if (trial.near_mse > 0) of_level["near_rmse_rgb"] = std::sqrt(trial.near_mse);
      for (const LevelTrial::Quads& quads : trial.quads)
        of_level["quads_rmse_rgb"].push_back(std::sqrt(quads.mse));
      meta["levels"].push_back(std::move(of_level));
    }
  if (!material.geometry.empty() && material.mode != Mode::kLod)
    meta["lookup"] = lookupMeta(material, atlases);
  const std::vector<TradePoint> front = paretoFront(trade);
  for (const TradePoint& p : trade) {
    const bool pareto = std::any_of(front.begin(), front.end(), [&](const TradePoint& f) {
      return f.bytes == p.bytes && f.rmse_y == p.rmse_y;
    });
    meta["trade"].push_back({{"y_components", p.plan.y_components},
                             {"surface_side", p.plan.surface_side},
                             {"coarse_components", p.plan.coarse_y},
                             {"phis", p.plan.phis},
                             {"flat_scale", p.plan.flat_scale},
                             {"bits", p.plan.storage == Storage::kSnorm16 ? 16 : 8},
                             {"geometry_side", p.plan.geometry_side},
                             {"bytes", p.bytes},
                             {"rmse_y", p.rmse_y},
                             {"pareto", pareto}});
  }
  return meta.dump(-1, ' ', false,
                   nlohmann::ordered_json::error_handler_t::replace);  // paths need not be UTF-8
}

}  // namespace loden::importer
