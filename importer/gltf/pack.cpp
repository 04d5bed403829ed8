#include "importer/gltf/pack.h"

#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "importer/base/file_read.h"
#include "importer/gltf/gltf_document.h"
#include "material/asset/asset.h"
#include "material/base/issues.h"
#include "material/model/color.h"
#include "material/system/atomic_file.h"
#include "material/system/confined_path.h"

namespace loden::importer {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

Issue extensionIssue(const fs::path& scene, const std::string& text) {
  return {issue_id::kGltfExtension, Severity::kError, scene.string(), text};
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

// Average colour and gloss of the material, as core glTF can say them.
Json fittedFallback(const Material& material) {
  glm::dvec3 color = glm::max(glm::dvec3(rgbFromYcc(glm::dvec3(material.mean.ka + material.mean.kd,
                                                               material.mean.cb, material.mean.cr))),
                              0.0);
  if (material.mean.chroma == MeanChroma::kRatio) {
    const double y = material.mean.ka + material.mean.kd;
    color = rgbFromYcc(glm::dvec3(y, material.mean.cb * y, material.mean.cr * y));
  }
  if (material.surface) {
    // The average; metals, too, are matt in it, as the tile's own shape is not in the fallback.
    const Texture& map = material.surface->color;
    const glm::vec4 code = fetchTexel(map, map.mips - 1, 0, 0, 0);
    if (map.mipWidth(map.mips - 1) == 1) color = glm::dvec3(code) * glm::dvec3(code);
  }
  color = glm::clamp(color, 0.0, 1.0);
  // GGX alpha^2 = 2 / (n + 2) (Walter et al. 2007), alpha = roughness^2 (glTF); no highlight is fully rough.
  const double n = std::max(0.0f, material.mean.alpha);
  const double roughness = material.mean.ks > 1e-3 ? std::pow(2 / (n + 2), 0.25) : 1;
  const auto rounded = [](double v) { return std::round(v * 1e5) / 1e5; };
  return {{"baseColorFactor", {rounded(color.x), rounded(color.y), rounded(color.z), 1.0}},
          {"metallicFactor", 0.0},
          {"roughnessFactor", rounded(std::clamp(roughness, 0.05, 1.0))}};
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

void declareUsed(Json& scene) {
  Json& used = scene["extensionsUsed"];
  if (!used.is_array()) used = Json::array();
  if (std::find(used.begin(), used.end(), kExtensionName) == used.end()) used.push_back(kExtensionName);
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

Json materialExtension(int64_t asset, const PackOptions& options) {
  Json extension{{"asset", asset}};
  if (options.tex_coord != 0) extension["texCoord"] = options.tex_coord;
  if (options.scale != glm::dvec2(1)) extension["scale"] = {options.scale.x, options.scale.y};
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

}  // namespace

Result<PackReport> pack(const PackOptions& options) {
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
  Copies copies;
  if (const Status status = planResources(document->json, options, copies); !status) return status.issue();
  const auto entry = referenceAsset(*document, options, *asset_bytes, copies, report);
  if (!entry) return entry.issue();
  const int64_t asset_index = assetIndex(document->json, *entry);
  Json& material = document->json["materials"][*index];
  material["extensions"][kExtensionName] = materialExtension(asset_index, options);
  report.fallback_fitted = options.fit_fallback || !material.contains("pbrMetallicRoughness");
  if (report.fallback_fitted) material["pbrMetallicRoughness"] = fittedFallback(*asset);
  declareUsed(document->json);

  for (const Copy& copy : copies)
    if (const Status status = copyFile(copy, report); !status) return status.issue();
  const std::string packed = serializeGltf(*document);
  if (const Status status = writeFileAtomically(options.output, std::as_bytes(std::span(packed))); !status)
    return status.issue();
  report.files.push_back(options.output);
  return report;
}

}  // namespace loden::importer
