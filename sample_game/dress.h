// Puts Loden materials onto the materials of a scene, in place of what its file says.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "material/base/result.h"
#include "material/model/uv_survey.h"
#include "runtime/scene/scene.h"

namespace loden::walk {

// What an asset says about its tile.
struct TileFacts {
  std::string name;    // the material's name, or the file's if the material has none
  double period = 0;   // length along x in metres; 0: not known
  double aspect = 1;   // length along y divided by the length along x
  glm::vec3 color{1};  // average colour, linear RGB
};
// Reads these facts from the asset's header. Issues: those of AssetFile::open.
Result<TileFacts> readTileFacts(const std::filesystem::path& asset);

// Length of a tile in metres where neither the asset nor the user names one.
inline constexpr double kUsualPeriod = 0.04;

// Index of the file in the scene's list of assets; adds it to the list if it is not there.
int assetIndex(runtime::Scene& scene, const std::filesystem::path& asset);

// Index of the material of that name; with an empty name, of the only material that meshes use. The issue is
// kOption, and lists the names of the scene's materials.
Result<int> findMaterial(const runtime::Scene& scene, const std::string& name);

// How texture coordinates lie on all instances that use the material.
UvSurvey surveyUvs(const runtime::Scene& scene, int material);

// Makes the scene's material show the asset, with tiles `period` metres long that are turned by `rotation`
// radians. The issue is kOption if no mesh with the material has texture coordinates, or if the tile is not
// square and the rotation is no multiple of a right angle.
Status dress(runtime::Scene& scene, int material, int asset, double period, double aspect, double rotation);

}  // namespace loden::walk
