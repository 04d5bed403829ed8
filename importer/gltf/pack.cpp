#include "importer/gltf/pack.h"

#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "importer/base/file_read.h"
#include "importer/gltf/fallback.h"
#include "importer/gltf/gltf_document.h"
#include "importer/gltf/measure_uvs.h"
#include "material/asset/asset.h"
#include "material/base/issues.h"
#include "material/base/memory_issue.h"
#include "material/system/atomic_file.h"
#include "material/system/confined_path.h"

namespace loden::importer {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

Issue extensionIssue(const fs::path& scene, const std::string& text) {
  return {issue_id::kGltfExtension, Severity::kError, scene.string(), text};
}

// Five significant digits, or as many as asked for.
std::string shortNumber(double value, int digits = 5) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

Result<int> findMaterial(const Json& scene, const PackOptions& options) {
  std::string names;
  for (size_t m = 0; m < arraySize(scene, "materials"); ++m) {
    const Json& material = scene["materials"][m];
    const std::string name = material.value("name", std::string());
    if (name == options.material) return static_cast<int>(m);
    names += (names.empty() ? "" : ", ") + ("'" + name + "'");
  }
  return extensionIssue(options.scene, "has no material '" + options.material + "'; it has " +
                                           (names.empty() ? "none" : names));
}

// Appends the asset's bytes as a bufferView: to the binary chunk of a GLB, else as a buffer with a data uri.
int64_t embedBytes(GltfDocument& document, const std::string& bytes) {
  Json& json = document.json;
  int64_t buffer = 0;
  size_t offset = 0;
  const bool own_chunk =
      document.binary && (arraySize(json, "buffers") == 0 || !json["buffers"][0].contains("uri"));
  if (own_chunk) {
    std::string& chunk = document.binary_chunk;
    chunk.append((4 - chunk.size() % 4) % 4, '\0');
    offset = chunk.size();
    chunk += bytes;
    if (arraySize(json, "buffers") == 0) json["buffers"] = Json::array({Json::object()});
    json["buffers"][0]["byteLength"] = chunk.size();
  } else {
    json["buffers"].push_back(
        {{"uri", "data:application/octet-stream;base64," + base64(bytes)}, {"byteLength", bytes.size()}});
    buffer = static_cast<int64_t>(json["buffers"].size()) - 1;
  }
  json["bufferViews"].push_back({{"buffer", buffer}, {"byteOffset", offset}, {"byteLength", bytes.size()}});
  return static_cast<int64_t>(json["bufferViews"].size()) - 1;
}

// Index of `entry` in the root extension's assets, added if it is not there.
int64_t assetIndex(Json& scene, const Json& entry) {
  Json& assets = scene["extensions"][kExtensionName]["assets"];
  if (!assets.is_array()) assets = Json::array();
  const auto found = std::find(assets.begin(), assets.end(), entry);
  const int64_t index = found - assets.begin();
  if (found == assets.end()) assets.push_back(entry);
  return index;
}

void declareUsed(Json& scene, const char* name) {
  Json& used = scene["extensionsUsed"];
  if (!used.is_array()) used = Json::array();
  if (std::find(used.begin(), used.end(), name) == used.end()) used.push_back(name);
}

// Files to copy, found out before the first one is: what fails, fails with nothing written.
struct Copy {
  fs::path from, to;
};
using Copies = std::vector<Copy>;

// Nothing stands at `to`, or the same bytes.
bool isFree(const fs::path& to, const std::string& bytes) {
  std::error_code error;
  if (!fs::exists(to, error)) return true;
  const auto present = readFile(to);
  return present && *present == bytes;
}

Status copyFile(const Copy& copy, PackReport& report) {
  std::error_code error;
  if (fs::equivalent(copy.from, copy.to, error)) return {};
  const auto bytes = readFile(copy.from);
  if (!bytes) return bytes.issue();
  fs::create_directories(copy.to.parent_path(), error);
  if (Status status = writeFileAtomically(copy.to, std::as_bytes(std::span(*bytes))); !status) return status;
  report.files.push_back(copy.to);
  return {};
}

// Buffers and images by uri go where the output looks for them.
Status planResources(const Json& scene, const PackOptions& options, Copies& copies) {
  const fs::path from = options.scene.parent_path(), to = options.output.parent_path();
  for (const char* list : {"buffers", "images"})
    for (size_t i = 0; i < arraySize(scene, list); ++i) {
      const std::string uri = scene[list][i].value("uri", std::string());
      if (uri.empty() || isDataUri(uri)) continue;
      const std::string where = options.scene.string() + ": " + list + "[" + std::to_string(i) + "].uri";
      const auto path = relativePathOfUri(uri, where);
      if (!path) return path.issue();
      if (const auto inside = confinedPath(from, uri, where); !inside) return inside.issue();
      std::error_code error;
      if (fs::equivalent(from / *path, to / *path, error)) continue;
      const auto bytes = readFile(from / *path);
      if (!bytes) return bytes.issue();
      if (!isFree(to / *path, *bytes))
        return Issue{issue_id::kExists, Severity::kError, (to / *path).string(),
                     "is another file than the scene's own; choose another folder for the output"};
      copies.push_back({from / *path, to / *path});
    }
  return {};
}

// <stem>-<8 digits of the bytes' hash>.loden
fs::path hashedName(const fs::path& path, const std::string& bytes) {
  char digits[12];
  std::snprintf(digits, sizeof digits, "-%08x",
                static_cast<unsigned>(XXH3_64bits(bytes.data(), bytes.size()) >> 32));
  return path.stem().string() + digits + path.extension().string();
}

// The asset as an entry of the root extension: embedded, or by uri with the file where the uri points.
Result<Json> referenceAsset(GltfDocument& document, const PackOptions& options, const std::string& bytes,
                            Copies& copies, PackReport& report) {
  if (options.embed) {
    const int64_t view = embedBytes(document, bytes);
    report.asset_reference = "bufferView " + std::to_string(view);
    return Json{{"bufferView", view}, {"mimeType", kAssetMimeType}};
  }
  const fs::path folder = fs::absolute(options.output).parent_path();
  fs::path relative =
      fs::absolute(options.asset).lexically_normal().lexically_relative(folder.lexically_normal());
  if (relative.empty() || *relative.begin() == "..") {
    relative = options.asset.filename();
    if (!isFree(folder / relative, bytes)) relative = hashedName(relative, bytes);
    if (!isFree(folder / relative, bytes))
      return Issue{issue_id::kExists, Severity::kError, (folder / relative).string(),
                   "is another file; choose another folder for the output"};
    copies.push_back({options.asset, folder / relative});
  }
  report.asset_reference = uriFromPath(relative);
  return Json{{"uri", report.asset_reference}};
}

std::string inPercent(double share) {
  return std::to_string(std::lround(100 * share)) + " %";
}

// Chooses the scale, measures what it makes of the tile, and remarks on both.
Status layOut(const UvSurvey& survey, const Material& asset, const PackOptions& options, PackReport& report) {
  const double period = options.period > 0 ? options.period : double(asset.period);
  if (survey.empty()) {
    if (!options.scale && options.period > 0)
      return Issue{issue_id::kOption, Severity::kError, "--period",
                   "the texture coordinates of '" + options.material + "' cannot be measured in " +
                       options.scene.string() +
                       ": no mesh of the default scene wears it uncompressed; give "
                       "--scale instead"};
    report.scale = options.scale.value_or(glm::dvec2(1));
    if (!options.scale && period > 0)
      report.remarks.push_back("no surface of '" + options.material +
                               "' can be measured, so that the tile repeats once per unit of texture "
                               "coordinate and not by its own length; --scale chooses");
    return {};
  }
  const glm::dvec2 metres = survey.metresPerUnit();
  if (options.scale || period == 0) {
    report.scale = options.scale.value_or(glm::dvec2(1));
  } else {
    const auto scale = scaleForPeriod(metres, period, double(asset.aspect), options.rotation);
    if (!scale)
      return Issue{issue_id::kOption, Severity::kError, "--rotation",
                   "the tile is no square, and only right angles keep its shape; give --scale instead of its "
                   "length for others"};
    report.scale = {std::stod(shortNumber(scale->x)), std::stod(shortNumber(scale->y))};
  }
  report.period = periodOfScale(metres, report.scale, options.rotation);
  const UvSurvey::Stretch stretch = survey.stretch(metres);
  report.stretch = stretch.most;
  report.stretched_share = stretch.share;
  if (!options.scale && period == 0)
    report.remarks.push_back(
        "the asset does not say how long its tile is: one is taken per unit of texture "
        "coordinate; --period chooses, as in --period 2cm");
  if (stretch.most > UvSurvey::kStrong)
    report.remarks.push_back("texture coordinates stretch the pattern up to " + shortNumber(stretch.most, 2) +
                             " times, and on " + inPercent(stretch.share) +
                             " of the area more than twice; unwrap the mesh more evenly to avoid it");
  return {};
}

// What the look of the material was made of, apart from what the extension keeps: alpha and emission by
// factors, and double sides.
void removeLook(Json& material) {
  for (const char* member :
       {"normalTexture", "occlusionTexture", "emissiveTexture", "emissiveFactor", "alphaMode", "alphaCutoff"})
    material.erase(member);
  if (!material.contains("extensions")) return;
  std::vector<std::string> looks;
  for (const auto& [name, value] : material["extensions"].items())
    if (name.starts_with("KHR_materials_") && name != "KHR_materials_variants") looks.push_back(name);
  for (const std::string& name : looks) material["extensions"].erase(name);
}

// A texture of the document, of a PNG inside it; as a member of a material.
Json addTexture(GltfDocument& document, const std::string& png, const std::string& name,
                const PackOptions& options, const glm::dvec2& scale) {
  Json& json = document.json;
  const int64_t view = embedBytes(document, png);
  json["images"].push_back({{"name", name}, {"bufferView", view}, {"mimeType", "image/png"}});
  json["samplers"].push_back({{"magFilter", 9729}, {"minFilter", 9987}});
  json["textures"].push_back(
      {{"source", json["images"].size() - 1}, {"sampler", json["samplers"].size() - 1}});
  Json use{{"index", json["textures"].size() - 1}};
  if (options.tex_coord != 0) use["texCoord"] = options.tex_coord;
  Json transform{{"scale", {scale.x, scale.y}}};
  if (options.rotation != 0) transform["rotation"] = options.rotation;
  use["extensions"]["KHR_texture_transform"] = transform;
  return use;
}

// The asset's look for viewers without the extension, in place of the material's own.
Status replaceLook(GltfDocument& document, int64_t index, const Material& asset, const PackOptions& options,
                   const glm::dvec2& scale) {
  const auto maps = bakeFallback(asset);
  if (!maps) return maps.issue();
  Json& json = document.json;
  Json look = fittedFactors(asset), normal;
  if (!maps->color_png.empty()) {
    const glm::vec3& factor = maps->color_factor;
    look["baseColorFactor"] = {factor.r, factor.g, factor.b, 1.0};
    look["baseColorTexture"] =
        addTexture(document, maps->color_png, options.material + " colours", options, scale);
    normal = addTexture(document, maps->normal_png, options.material + " normals", options, scale);
    declareUsed(json, "KHR_texture_transform");
  }
  Json& material = json["materials"][static_cast<size_t>(index)];
  removeLook(material);
  material["pbrMetallicRoughness"] = look;
  if (!normal.is_null()) material["normalTexture"] = normal;
  if (maps->sheen != glm::vec3(0)) {
    material["extensions"]["KHR_materials_sheen"] = {
        {"sheenColorFactor", {maps->sheen.r, maps->sheen.g, maps->sheen.b}},
        {"sheenRoughnessFactor", maps->sheen_roughness}};
    declareUsed(json, "KHR_materials_sheen");
  }
  return {};
}

Json materialExtension(int64_t asset, const PackOptions& options, const glm::dvec2& scale) {
  Json extension{{"asset", asset}};
  if (options.tex_coord != 0) extension["texCoord"] = options.tex_coord;
  if (scale != glm::dvec2(1)) extension["scale"] = {scale.x, scale.y};
  if (options.rotation != 0) extension["rotation"] = options.rotation;
  return extension;
}

// Every mesh part that wears the material needs the set of texture coordinates.
Status checkTexCoords(const Json& scene, int material, const PackOptions& options) {
  const std::string attribute = "TEXCOORD_" + std::to_string(options.tex_coord);
  const std::vector<std::string> bare = primitivesWithout(scene, material, attribute);
  if (bare.empty()) return {};
  return extensionIssue(options.scene, bare.front() + " wears '" + options.material + "' and has no " +
                                           attribute +
                                           "; unwrap the mesh, or name another set with --texcoord");
}

Result<PackReport> packScene(const PackOptions& options) {
  const auto scene_bytes = readFile(options.scene);
  if (!scene_bytes) return scene_bytes.issue();
  auto document = parseGltf(*scene_bytes, options.scene.string());
  if (!document) return document.issue();
  if (document->binary != (options.output.extension() == ".glb"))
    return Issue{issue_id::kVersion, Severity::kError, options.output.string(),
                 "must be the same kind of file as the scene: .gltf to .gltf, .glb to .glb"};
  if (const auto wrong = wrongTypes(document->json, options.scene.string()); !wrong.empty())
    return wrong.front();
  const auto asset_bytes = readFile(options.asset);
  if (!asset_bytes) return asset_bytes.issue();
  const auto asset = parseAsset(std::as_bytes(std::span(*asset_bytes)), options.asset.string());
  if (!asset) return asset.issue();
  const auto index = findMaterial(document->json, options);
  if (!index) return index.issue();
  if (const Status status = checkTexCoords(document->json, *index, options); !status) return status.issue();
  std::error_code error;
  if (const fs::path folder = fs::absolute(options.output).parent_path(); !fs::is_directory(folder, error))
    return Issue{issue_id::kCannotWrite, Severity::kError, options.output.string(),
                 "the folder is not there; make it first"};

  PackReport report;
  report.material = *index;
  GltfBuffers buffers(*document, options.scene);
  const UvSurvey survey = surveyUvs(document->json, buffers, *index, options.tex_coord);
  if (const Status status = layOut(survey, *asset, options, report); !status) return status.issue();
  Copies copies;
  if (const Status status = planResources(document->json, options, copies); !status) return status.issue();
  const auto entry = referenceAsset(*document, options, *asset_bytes, copies, report);
  if (!entry) return entry.issue();
  const int64_t asset_index = assetIndex(document->json, *entry);
  {
    Json& material = document->json["materials"][*index];
    material["extensions"][kExtensionName] = materialExtension(asset_index, options, report.scale);
    report.fallback_fitted = options.fit_fallback || !material.contains("pbrMetallicRoughness");
    if (report.fallback_fitted && !options.fit_fallback)
      material["pbrMetallicRoughness"] = fittedFactors(*asset);
  }
  declareUsed(document->json, kExtensionName);
  if (options.fit_fallback)
    if (const Status status = replaceLook(*document, *index, *asset, options, report.scale); !status)
      return status.issue();

  for (const Copy& copy : copies)
    if (const Status status = copyFile(copy, report); !status) return status.issue();
  const std::string packed = serializeGltf(*document);
  if (const Status status = writeFileAtomically(options.output, std::as_bytes(std::span(packed))); !status)
    return status.issue();
  report.files.push_back(options.output);
  return report;
}

}  // namespace

Result<PackReport> pack(const PackOptions& options) {
  return withMemoryIssue(options.scene.native(), "packing this scene", [&] { return packScene(options); });
}

}  // namespace loden::importer
