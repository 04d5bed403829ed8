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

// Index of the last element of an array member.
int64_t lastOf(const Json& object, const char* key) {
  return static_cast<int64_t>(arraySize(object, key)) - 1;
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
    Json& buffers = listOf(json, "buffers");
    memberOf(buffers.empty() ? appendTo(buffers) : buffers[0], "byteLength") = chunk.size();
  } else {
    Json& added = appendTo(listOf(json, "buffers"));
    memberOf(added, "uri") = "data:application/octet-stream;base64," + base64(bytes);
    memberOf(added, "byteLength") = bytes.size();
    buffer = lastOf(json, "buffers");
  }
  Json& view = appendTo(listOf(json, "bufferViews"));
  memberOf(view, "buffer") = buffer;
  memberOf(view, "byteOffset") = offset;
  memberOf(view, "byteLength") = bytes.size();
  return lastOf(json, "bufferViews");
}

// An entry of the root extension's assets.
struct AssetEntry {
  std::string uri;  // empty: embedded
  int64_t view = -1;
};

bool refersTo(const Json& entry, const std::string& uri) {
  const auto found = entry.find("uri");
  return entry.size() == 1 && found != entry.end() && found->is_string() &&
         found->get_ref<const std::string&>() == uri;
}

// Its index, added if it is not there.
int64_t assetIndex(Json& scene, const AssetEntry& entry) {
  Json& assets = listOf(memberOf(memberOf(scene, "extensions"), kExtensionName), "assets");
  for (size_t i = 0; i < assets.size(); ++i)
    if (refersTo(assets[i], entry.uri)) return static_cast<int64_t>(i);
  Json& added = appendTo(assets);
  if (entry.uri.empty()) {
    memberOf(added, "bufferView") = entry.view;
    memberOf(added, "mimeType") = kAssetMimeType;
  } else {
    memberOf(added, "uri") = entry.uri;
  }
  return static_cast<int64_t>(assets.size()) - 1;
}

void declareUsed(Json& scene, const char* name) {
  Json& used = listOf(scene, "extensionsUsed");
  for (const Json& other : used)
    if (other.get_ref<const std::string&>() == name) return;
  appendTo(used) = name;
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
Result<AssetEntry> referenceAsset(GltfDocument& document, const PackOptions& options,
                                  const std::string& bytes, Copies& copies, PackReport& report) {
  if (options.embed) {
    const int64_t view = embedBytes(document, bytes);
    report.asset_reference = "bufferView " + std::to_string(view);
    return AssetEntry{{}, view};
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
  return AssetEntry{report.asset_reference};
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
  constexpr const char* kLook[] = {"normalTexture",  "occlusionTexture", "emissiveTexture",
                                   "emissiveFactor", "alphaMode",        "alphaCutoff"};
  removeMembers(material, [&](const std::string& name) {
    return std::find(std::begin(kLook), std::end(kLook), name) != std::end(kLook);
  });
  if (!material.contains("extensions")) return;
  removeMembers(material["extensions"], [](const std::string& name) {
    return name.starts_with("KHR_materials_") && name != "KHR_materials_variants";
  });
}

// A texture of the document, of a PNG inside it.
int64_t addTexture(GltfDocument& document, const std::string& png, const std::string& name) {
  Json& json = document.json;
  const int64_t view = embedBytes(document, png);
  Json& image = appendTo(listOf(json, "images"));
  memberOf(image, "name") = name;
  memberOf(image, "bufferView") = view;
  memberOf(image, "mimeType") = "image/png";
  Json& sampler = appendTo(listOf(json, "samplers"));
  memberOf(sampler, "magFilter") = 9729;
  memberOf(sampler, "minFilter") = 9987;
  Json& texture = appendTo(listOf(json, "textures"));
  memberOf(texture, "source") = lastOf(json, "images");
  memberOf(texture, "sampler") = lastOf(json, "samplers");
  return lastOf(json, "textures");
}

// What a member of a material says of its texture.
void useTexture(Json& use, int64_t texture, const PackOptions& options, const glm::dvec2& scale) {
  memberOf(use, "index") = texture;
  if (options.tex_coord != 0) memberOf(use, "texCoord") = options.tex_coord;
  Json& transform = memberOf(memberOf(use, "extensions"), "KHR_texture_transform");
  setNumbers(memberOf(transform, "scale"), {scale.x, scale.y});
  if (options.rotation != 0) memberOf(transform, "rotation") = options.rotation;
}

// The asset's look for viewers without the extension, in place of the material's own.
Status replaceLook(GltfDocument& document, int64_t index, const Material& asset, const PackOptions& options,
                   const glm::dvec2& scale) {
  const auto maps = bakeFallback(asset);
  if (!maps) return maps.issue();
  const bool textured = !maps->color_png.empty();
  int64_t colors = -1, normals = -1;
  if (textured) {
    colors = addTexture(document, maps->color_png, options.material + " colours");
    normals = addTexture(document, maps->normal_png, options.material + " normals");
    declareUsed(document.json, "KHR_texture_transform");
  }
  Json& material = document.json["materials"][static_cast<size_t>(index)];
  removeLook(material);
  Json& look = memberOf(material, "pbrMetallicRoughness");
  fitFactors(look, asset);
  if (textured) {
    const glm::vec3& factor = maps->color_factor;
    setNumbers(memberOf(look, "baseColorFactor"), {factor.r, factor.g, factor.b, 1.0});
    useTexture(memberOf(look, "baseColorTexture"), colors, options, scale);
    useTexture(memberOf(material, "normalTexture"), normals, options, scale);
  }
  if (maps->sheen != glm::vec3(0)) {
    Json& sheen = memberOf(memberOf(material, "extensions"), "KHR_materials_sheen");
    setNumbers(memberOf(sheen, "sheenColorFactor"), {maps->sheen.r, maps->sheen.g, maps->sheen.b});
    memberOf(sheen, "sheenRoughnessFactor") = maps->sheen_roughness;
    declareUsed(document.json, "KHR_materials_sheen");
  }
  return {};
}

void extendMaterial(Json& extension, int64_t asset, const PackOptions& options, const glm::dvec2& scale) {
  setNull(extension);
  memberOf(extension, "asset") = asset;
  if (options.tex_coord != 0) memberOf(extension, "texCoord") = options.tex_coord;
  if (scale != glm::dvec2(1)) setNumbers(memberOf(extension, "scale"), {scale.x, scale.y});
  if (options.rotation != 0) memberOf(extension, "rotation") = options.rotation;
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
    extendMaterial(memberOf(memberOf(material, "extensions"), kExtensionName), asset_index, options,
                   report.scale);
    report.fallback_fitted = options.fit_fallback || !material.contains("pbrMetallicRoughness");
    if (report.fallback_fitted && !options.fit_fallback)
      fitFactors(memberOf(material, "pbrMetallicRoughness"), *asset);
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
