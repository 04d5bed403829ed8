// Puts Loden materials onto the materials of a scene, in place of what its file says.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "material/base/result.h"
#include "material/model/uv_survey.h"
#include "runtime/scene/scene.h"

namespace loden::walk {

// What a file says of its tile.
struct TileFacts {
  std::string name;    // of the material; the file's own where it has none
  double period = 0;   // metres along x; 0: not known
  double aspect = 1;   // length along y to that along x
  glm::vec3 color{1};  // average, linear RGB
};
// Issues of AssetFile::open.
Result<TileFacts> readTileFacts(const std::filesystem::path& asset);

// Of a tile whose length nobody has said.
inline constexpr double kUsualPeriod = 0.04;  // metres

// Index of the file among the scene's assets, where it is added if it is new.
int assetIndex(runtime::Scene& scene, const std::filesystem::path& asset);

// Index of the material by its name, or the only one that meshes wear if the name is empty. kOption with the
// names that there are.
Result<int> findMaterial(const runtime::Scene& scene, const std::string& name);

// Of all instances that wear the material.
UvSurvey surveyUvs(const runtime::Scene& scene, int material);

// The material wears the asset, whose tile is then `period` metres long, turned by `rotation` radians.
// kOption if nothing that wears the material has texture coordinates, or the tile is no square and turned
// askew.
Status dress(runtime::Scene& scene, int material, int asset, double period, double aspect, double rotation);

}  // namespace loden::walk
