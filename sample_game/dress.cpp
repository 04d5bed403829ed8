#include "sample_game/dress.h"

#include <algorithm>

#include "material/base/issues.h"
#include "material/model/color.h"
#include "material/system/asset_io.h"

namespace loden::walk {

using namespace runtime;

namespace {

Issue optionIssue(const Scene& scene, const std::string& text) {
  return {issue_id::kOption, Severity::kError, scene.name, text};
}

std::vector<bool> wornMaterials(const Scene& scene) {
  std::vector<bool> worn(scene.materials.size());
  for (const Instance& instance : scene.instances)
    if (instance.material >= 0) worn[size_t(instance.material)] = true;
  return worn;
}

}  // namespace

Result<TileFacts> readTileFacts(const std::filesystem::path& asset) {
  auto source = openFileSource(asset);
  if (!source) return source.issue();
  const auto file = AssetFile::open(std::move(*source), asset.string());
  if (!file) return file.issue();
  const Material& material = file->skeleton();
  TileFacts facts;
  facts.name = material.name.empty() ? asset.stem().string() : material.name;
  facts.period = double(material.period);
  facts.aspect = double(material.aspect);
  const PhongMean& mean = material.mean;
  const double y = double(mean.ka + mean.kd), chroma = mean.chroma == MeanChroma::kRatio ? y : 1.0;
  facts.color = glm::clamp(
      glm::vec3(rgbFromYcc(glm::dvec3(y, double(mean.cb) * chroma, double(mean.cr) * chroma))), 0.02f, 0.9f);
  return facts;
}

int assetIndex(Scene& scene, const std::filesystem::path& asset) {
  for (size_t i = 0; i < scene.assets.size(); ++i)
    if (scene.assets[i].path == asset) return static_cast<int>(i);
  scene.assets.push_back({asset, {}, asset.string()});
  return static_cast<int>(scene.assets.size()) - 1;
}

Result<int> findMaterial(const Scene& scene, const std::string& name) {
  const std::vector<bool> worn = wornMaterials(scene);
  std::string names;
  int only = -1;
  for (size_t i = 0; i < scene.materials.size(); ++i) {
    if (!worn[i]) continue;
    if (!name.empty() && scene.materials[i].name == name) return static_cast<int>(i);
    only = only == -1 ? static_cast<int>(i) : -2;
    names += (names.empty() ? "'" : ", '") + scene.materials[i].name + "'";
  }
  if (name.empty() && only >= 0) return only;
  return optionIssue(scene, (name.empty() ? "has more or fewer than one material; choose by --material"
                                          : "has no material '" + name + "'") +
                                std::string("; meshes wear ") + (names.empty() ? "none" : names));
}

UvSurvey surveyUvs(const Scene& scene, int material) {
  UvSurvey survey;
  for (const Instance& instance : scene.instances) {
    if (instance.material != material) continue;
    const Mesh& mesh = scene.meshes[size_t(instance.mesh)];
    const glm::dmat4 world(instance.world_from_local);
    for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
      std::array<glm::dvec3, 3> positions;
      std::array<glm::dvec2, 3> uvs;
      for (size_t k = 0; k < 3; ++k) {
        const Vertex& vertex = mesh.vertices[mesh.indices[i + k]];
        positions[k] = glm::dvec3(world * glm::dvec4(glm::dvec3(vertex.position), 1));
        uvs[k] = glm::dvec2(vertex.uv);
      }
      survey.add(positions, uvs);
    }
  }
  return survey;
}

Status dress(Scene& scene, int material, int asset, double period, double aspect, double rotation) {
  const std::string name = "'" + scene.materials[size_t(material)].name + "'";
  const UvSurvey survey = surveyUvs(scene, material);
  if (survey.empty())
    return optionIssue(scene, "what wears " + name + " has no texture coordinates; unwrap the mesh first");
  const auto scale = scaleForPeriod(survey.metresPerUnit(), period, aspect, rotation);
  if (!scale)
    return optionIssue(scene,
                       "the tile on " + name + " is no square, and can only be turned by right angles");
  FlatBtfBinding binding;
  binding.asset = asset;
  binding.scale = glm::vec2(*scale);
  binding.rotation = static_cast<float>(rotation);
  scene.materials[size_t(material)].flat_btf = binding;
  return {};
}

}  // namespace loden::walk
