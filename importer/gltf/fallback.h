// The look of a material for viewers that do not know the extension: core glTF, KHR_materials_sheen and
// KHR_texture_transform. Not installed.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "material/base/result.h"
#include "material/model/material.h"

namespace loden::importer {

// Turns `look` into a pbrMetallicRoughness of factors alone: average colour and gloss.
void fitFactors(nlohmann::ordered_json& look, const Material& material);

// One period of the tile seen from straight above, and the material's factors that go with these maps.
struct FallbackMaps {
  std::string color_png, normal_png;  // square; the first row is at x.y = 0. Empty without surface maps
  glm::vec3 color_factor{1};          // the colour map times this factor is as bright as the tile on average
  glm::vec3 sheen{0};                 // KHR_materials_sheen: the additional brightness of grazing views
  float sheen_roughness = 0.5f;
};
Result<FallbackMaps> bakeFallback(const Material& material);

}  // namespace loden::importer
