#include "importer/btf/baked_output.h"

#include <cmath>

#include "importer/base/file_read.h"
#include "importer/base/image_file.h"
#include "importer/base/repair_log.h"
#include "importer/btf/baked_files.h"
#include "material/base/issues.h"

namespace loden::importer {
namespace {

namespace fs = std::filesystem;

Issue missingMap(const fs::path& folder, const char* map) {
  return {issue_id::kBakeIncomplete, Severity::kError, folder.string(),
          std::string("the bake has no ") + map + " maps; bake again with --maps including them"};
}

Result<Image> readSized(const fs::path& path, int width, int height, int channels) {
  auto image = readImage(path);
  if (!image) return image.issue();
  if (image->width != width || image->height != height || image->channels != channels)
    return Issue{issue_id::kImage, Severity::kError, path.string(),
                 "is " + std::to_string(image->width) + " x " + std::to_string(image->height) + " x " +
                     std::to_string(image->channels) + "; bake.json asks for " + std::to_string(width) +
                     " x " + std::to_string(height) + " x " + std::to_string(channels)};
  return image;
}

Result<std::vector<glm::vec3>> readAtlas(const fs::path& path, const AtlasLayout& layout) {
  const auto image = readSized(path, layout.width(), layout.height(), 3);
  if (!image) return image.issue();
  std::vector<glm::vec3> values;
  values.reserve(size_t(layout.cells) * layout.side * layout.side);
  for (int cell = 0; cell < layout.cells; ++cell)
    for (int j = 0; j < layout.side; ++j) {
      const float* row = &image->pixels[3 * layout.pixel(cell, 0, j)];
      for (int i = 0; i < layout.side; ++i) values.emplace_back(row[3 * i], row[3 * i + 1], row[3 * i + 2]);
    }
  return values;
}

template <class Texel>
std::vector<Texel> texelsOf(const Image& image) {
  std::vector<Texel> texels(size_t(image.width) * size_t(image.height));
  for (size_t t = 0; t < texels.size(); ++t)
    for (int c = 0; c < image.channels; ++c)
      texels[t][c] = image.pixels[t * size_t(image.channels) + size_t(c)];
  return texels;
}

// Refuses values that are not finite, or repairs them and says so in the log. `part`: the map in messages.
template <class Texel>
Status makeFinite(std::vector<Texel>& texels, const MapShape& shape, const char* part, const fs::path& path,
                  RepairLog* repairs) {
  const std::span<float> values(&texels.data()->x, texels.size() * size_t(Texel::length()));
  const NonFinite bad = repairs ? repairNonFinite(values, shape) : findNonFinite(values);
  if (bad.count == 0) return {};
  const std::string place = placeOf(bad.first, shape, shape.layers > 1 ? "direction" : "");
  if (repairs) return repairs->add(part, bad.count, place), Status();
  return Issue{issue_id::kNonFinite, Severity::kError, path.string(),
               std::to_string(bad.count) + " values are not finite, the first at " + place +
                   "; --fix-nonfinite repairs them"};
}

}  // namespace

Result<BakedOutput> BakedOutput::open(const fs::path& folder, std::shared_ptr<RepairLog> repairs) {
  const fs::path path = folder / "bake.json";
  std::error_code error;
  if (Status status = checkOpens(folder, Openable::kFileOrFolder); !status) return status.issue();
  if (!fs::exists(path, error))
    return Issue{
        issue_id::kBakeIncomplete, Severity::kError, folder.string(),
        "no bake.json: not a baked output, or a bake that has not finished (bake again with --resume)"};
  const auto text = readFile(path);
  if (!text) return text.issue();
  auto manifest = parseManifest(*text, path.string());
  if (!manifest) return manifest.issue();
  BakedOutput output = unfinished(folder, std::move(*manifest));
  output.repairs_ = std::move(repairs);
  return output;
}

BakedOutput BakedOutput::unfinished(const fs::path& folder, BakeManifest manifest) {
  BakedOutput output;
  output.folder_ = folder;
  output.manifest_ = std::move(manifest);
  return output;
}

Result<std::vector<glm::vec3>> BakedOutput::btfView(int view) const {
  LODEN_CHECK_LT(view, manifest_.directions.size());
  if (!manifest_.has_btf) return missingMap(folder_, "btf");
  return readAtlas(btfPath(folder_, view),
                   AtlasLayout::forLights(manifest_.size, manifest_.directions.size()));
}

Result<std::vector<glm::vec3>> BakedOutput::flatView(int view) const {
  LODEN_CHECK_LT(view, manifest_.directions.size());
  if (!manifest_.has_flat) return missingMap(folder_, "flat");
  return readAtlas(flatPath(folder_, view),
                   AtlasLayout::forLights(manifest_.flat_size, manifest_.directions.size()));
}

Result<std::vector<float>> BakedOutput::visibleView(int view) const {
  LODEN_CHECK_LT(view, manifest_.directions.size());
  if (!manifest_.has_flat) return missingMap(folder_, "flat");
  auto image = readSized(visiblePath(folder_, view), manifest_.flat_size, manifest_.flat_size, 1);
  if (!image) return image.issue();
  return std::move(image->pixels);
}

Result<std::vector<glm::vec2>> BakedOutput::vdim(int zeniths, int azimuths) const {
  if (!manifest_.has_vdim) return missingMap(folder_, "vdim");
  const int side = manifest_.size;
  const auto image = readSized(vdimPath(folder_, {zeniths, azimuths}), side * azimuths, side * zeniths, 2);
  if (!image) return image.issue();
  const AtlasLayout layout{side, zeniths * azimuths, azimuths};
  std::vector<glm::vec2> values;
  values.reserve(image->pixels.size() / 2);
  for (int cell = 0; cell < layout.cells; ++cell)
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        const float* pixel = &image->pixels[2 * layout.pixel(cell, i, j)];
        values.emplace_back(pixel[0], pixel[1]);
      }
  const Status finite = makeFinite(values, {layout.cells, side, side, 2}, "vdim",
                                   vdimPath(folder_, {zeniths, azimuths}), repairs_.get());
  if (!finite) return finite.issue();
  return values;
}

Result<std::vector<float>> BakedOutput::concentricVdim(int directions) const {
  const int side = manifest_.size;
  const auto image =
      readSized(concentricVdimPath(folder_, directions), side * directions, side * directions, 1);
  if (!image) return image.issue();
  const AtlasLayout layout{side, directions * directions, directions};
  std::vector<float> values;
  values.reserve(image->pixels.size());
  for (int cell = 0; cell < layout.cells; ++cell)
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) values.push_back(image->pixels[layout.pixel(cell, i, j)]);
  return values;
}

Result<std::vector<glm::vec4>> BakedOutput::geometry() const {
  if (!manifest_.has_surface) return missingMap(folder_, "surface");
  const int side = manifest_.geometry_size;
  const fs::path path = surfacePath(folder_, "geometry");
  const auto image = readSized(path, side, side, 4);
  if (!image) return image.issue();
  auto texels = texelsOf<glm::vec4>(*image);
  std::vector<size_t> without_chart;  // charts have no mean: a repaired one is none
  for (size_t t = 0; t < texels.size(); ++t)
    if (!std::isfinite(texels[t].w)) without_chart.push_back(t);
  if (const Status finite = makeFinite(texels, {1, side, side, 4}, "geometry", path, repairs_.get()); !finite)
    return finite.issue();
  for (const size_t t : without_chart) texels[t].w = 0;
  return texels;
}

Result<BakedOutput::Surface> BakedOutput::surface() const {
  if (!manifest_.has_surface) return missingMap(folder_, "surface");
  const int side = manifest_.surface_size;
  const auto normal = readSized(surfacePath(folder_, "normal"), side, side, 3);
  if (!normal) return normal.issue();
  const auto diffuse = readSized(surfacePath(folder_, "diffuse"), side, side, 3);
  if (!diffuse) return diffuse.issue();
  const auto specular = readSized(surfacePath(folder_, "specular"), side, side, 2);
  if (!specular) return specular.issue();
  Surface maps{
      texelsOf<glm::vec3>(*normal), texelsOf<glm::vec3>(*diffuse), texelsOf<glm::vec2>(*specular), {}};
  if (manifest_.has_ggx) {
    const auto ggx = readSized(surfacePath(folder_, "ggx"), side, side, 4);
    if (!ggx) return ggx.issue();
    maps.ggx = texelsOf<glm::vec4>(*ggx);
  }
  const auto check = [&](auto& texels, int channels, const char* map) {
    return makeFinite(texels, {1, side, side, channels}, map, surfacePath(folder_, map), repairs_.get());
  };
  if (const Status finite = check(maps.normal, 3, "normal"); !finite) return finite.issue();
  if (const Status finite = check(maps.diffuse, 3, "diffuse"); !finite) return finite.issue();
  if (const Status finite = check(maps.specular, 2, "specular"); !finite) return finite.issue();
  if (manifest_.has_ggx)
    if (const Status finite = check(maps.ggx, 4, "ggx"); !finite) return finite.issue();
  return maps;
}

}  // namespace loden::importer
