// loden extract X -o slice.exr: one light-view slice, or a stored map.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "importer/base/file_read.h"
#include "importer/base/picture.h"
#include "importer/btf/btf_source.h"
#include "importer/btf/packed_lod.h"
#include "importer/cli/input_kind.h"
#include "importer/cli/interrupt.h"
#include "importer/cli/output.h"
#include "material/asset/asset.h"
#include "material/base/issues.h"
#include "material/system/asset_io.h"
#include "material/system/threads.h"

namespace loden::importer {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegrees = 180.0 / kPi;

// Row 0 of a slice is y = 0; pictures have their top row first, so y points up in them.
Picture pictureFromSlice(const std::vector<glm::vec3>& slice, glm::ivec2 size) {
  Picture picture{size.x, size.y, std::vector<glm::vec4>(slice.size())};
  for (int y = 0; y < size.y; ++y)
    for (int x = 0; x < size.x; ++x)
      picture.at(x, size.y - 1 - y) = glm::vec4(slice[size_t(y) * size.x + x], 1);
  return picture;
}

// Layers (or z) of mip 0 from the top down, each with its own row 0 at its top.
Picture pictureFromTexture(const Texture& texture) {
  Picture picture{texture.width, texture.height * texture.depth, {}};
  picture.pixels.reserve(size_t(picture.width) * picture.height);
  for (int z = 0; z < texture.depth; ++z)
    for (int y = 0; y < texture.height; ++y)
      for (int x = 0; x < texture.width; ++x) picture.pixels.push_back(fetchTexel(texture, 0, x, y, z));
  return picture;
}

// Cells of side x side, [cell][row][column], in rows of `columns` from the top down; y points up in each.
template <class Value, class ToPixel>
Picture mosaic(const std::vector<Value>& values, int side, int columns, const ToPixel& to_pixel) {
  const int cells = static_cast<int>(values.size() / (size_t(side) * size_t(side)));
  const int rows = (cells + columns - 1) / columns;
  Picture picture{side * columns, side * rows,
                  std::vector<glm::vec4>(size_t(side) * size_t(side) * size_t(columns) * size_t(rows))};
  for (int cell = 0; cell < cells; ++cell)
    for (int t = 0; t < side * side; ++t)
      picture.at(cell % columns * side + t % side, cell / columns * side + side - 1 - t / side) =
          to_pixel(values[size_t(cell) * size_t(side) * size_t(side) + size_t(t)]);
  return picture;
}

class ExtractCommand : public Command {
 public:
  std::string_view name() const override { return "extract"; }
  std::string_view summary() const override {
    return "Write one light-view slice of a material, or a stored map, as a picture";
  }

  void declare(Options& options) override {
    options.path("input", input_, "Asset (decoded slice) or baked output (true slice)", true);
    options.text("--light", light_, "Light direction THETA,PHI in degrees");
    options.text("--view", view_, "View direction THETA,PHI in degrees");
    options.number("--lambda", lambda_, "Level of detail");
    options.choice("--domain", domain_, {"reference", "flat"},
                   "reference: as seen, over x; flat: unwrapped, over p");
    options.choice("--lookup", lookup_, {"default", "fast", "paper", "quality", "none"},
                   "How the asset finds p");
    options.integer("--side", side_, "Texels per side; 0: the material's at lambda", 0, 8192);
    options.text("--map", map_,
                 "Write this stored map instead, for example normal, band0.weights, or of a bake "
                 "vdim.latlong:16x16; a wrong name lists those there are; of a seed preset also packed.eigen "
                 "and packed.weights (Ma et al. 2005, figure 5)");
    options.path("-o,--output", output_, ".exr (linear), .hdr, .png or .jpg (sRGB)", true);
    options.footer("Of a baked output, light and view are the nearest sampled ones; the report names them.");
  }

  int run(const GlobalOptions& globals) override {
    const auto light = parseDirection("--light", light_), view = parseDirection("--view", view_);
    if (!light) return fail(light.issue());
    if (!view) return fail(view.issue());
    if (const Status status = checkPictureName(output_); !status) return fail(status.issue());
    if (!(lambda_ >= 0 && lambda_ <= 32)) return failUsage("--lambda: must be 0 to 32");
    if (const Status status = checkOpens(input_, Openable::kFileOrFolder); !status)
      return fail(status.issue());
    const auto picture = [&]() -> Result<Picture> {
      switch (inputKind(input_)) {
        case InputKind::kAsset:
          return map_.empty() ? assetSlice(*light, *view, globals) : assetMap();
        case InputKind::kBakedOutput:
          return map_.empty() ? bakedSlice(*light, *view) : bakedMap();
        default:
          return Issue{issue_id::kBakeManifest, Severity::kError, input_.string(),
                       "is neither a .loden file nor a baked output (no bake.json)"};
      }
    }();
    if (!picture) return fail(picture.issue());
    const Status written = [&] {
      const CommitScope commit;
      return writePicture(*picture, output_);
    }();
    if (!written) return fail(written.issue());
    report_["output"] = output_.string();
    report_["width"] = picture->width;
    report_["height"] = picture->height;
    if (globals.json)
      printJson("extract", report_);
    else
      printText(formatted("%s: %d x %d\n", output_.c_str(), picture->width, picture->height) +
                directionsText());
    return kExitOk;
  }

 private:
  // Of a baked output's slice the sampled directions, which need not be those asked for.
  std::string directionsText() const {
    if (report_.value("kind", "") != "true") return {};
    const auto angles = [this](const char* key) {
      return formatted("%.2f, %.2f", report_[key][0].get<double>(), report_[key][1].get<double>());
    };
    return "nearest samples: light " + angles("light") + ", view " + angles("view") +
           " degrees (theta, phi)\n";
  }

  void reportDirection(const char* key, const glm::dvec3& w) {
    const Spherical s = sphericalFromDirection(w);
    report_[key] = {s.theta * kDegrees, s.phi * kDegrees};
  }

  Result<Picture> assetSlice(const glm::dvec3& light, const glm::dvec3& view, const GlobalOptions& globals) {
    const auto material = readAsset(input_);
    if (!material) return material.issue();
    Evaluator evaluator(*material, onThreads(globals.threads));
    const auto lookup = prepareLookup(evaluator, lookupNamed(lookup_).value(), input_);
    if (!lookup) return lookup.issue();
    const int side =
        side_ > 0 ? side_ : std::max(1, material->side >> std::min(31, static_cast<int>(lambda_)));
    const MaterialSampling sampling{
        side, lambda_, *lookup, domain_ == "flat" ? Domain::kFlat : Domain::kReference, {}, {}};
    report_ = {{"input", input_.string()},
               {"kind", "decoded"},
               {"domain", domain_},
               {"lambda", lambda_},
               {"lookup", std::string(lookupName(*lookup))}};
    reportDirection("light", light);
    reportDirection("view", view);
    return pictureFromSlice(materialSlice(evaluator, sampling, light, view), glm::ivec2(side));
  }

  Result<Picture> assetMap() {
    const auto material = readAsset(input_);
    if (!material) return material.issue();
    if (map_ == "packed.eigen" || map_ == "packed.weights") {
      const auto packed = packLod(*material);
      if (!packed) return packed.issue();
      report_ = {{"input", input_.string()}, {"kind", "map"}, {"map", map_}};
      return map_ == "packed.eigen" ? packed->eigen : packed->weights;
    }
    std::string known;
    report_ = {{"input", input_.string()}, {"kind", "map"}, {"map", map_}};
    for (const MaterialPart& part : materialParts(*material))
      for (const auto& map : mapsOf(*material, part)) {
        const std::string name = mapName(part, map.name);
        if (name == map_) return pictureFromTexture(*map.texture);
        known += (known.empty() ? "" : ", ") + name;
      }
    return Issue{issue_id::kOption, Severity::kError, "--map " + map_,
                 "this asset has no such map; it has " + known};
  }

  Result<Picture> bakedSlice(const glm::dvec3& light, const glm::dvec3& view) {
    const auto baked = BakedOutput::open(input_);
    if (!baked) return baked.issue();
    if (lambda_ != 0)
      return Issue{issue_id::kOption, Severity::kError, "--lambda", "a baked output has level 0 only"};
    const DirectionSet& directions = baked->manifest().directions;
    const int l = nearestDirection(directions, light), v = nearestDirection(directions, view);
    const bool flat = domain_ == "flat";
    const auto images = flat ? baked->flatView(v) : baked->btfView(v);
    if (!images) return images.issue();
    const int side = flat ? baked->manifest().flat_size : baked->manifest().size;
    const auto first = images->begin() + static_cast<ptrdiff_t>(l) * side * side;
    report_ = {{"input", input_.string()}, {"kind", "true"}, {"domain", domain_}, {"lambda", 0}};
    reportDirection("light", directions.samples[l]);
    reportDirection("view", directions.samples[v]);
    return pictureFromSlice({first, first + side * side}, glm::ivec2(side));
  }

  Result<Picture> bakedMap() {
    const auto baked = BakedOutput::open(input_);
    if (!baked) return baked.issue();
    if (map_.starts_with("vdim.") || map_ == "geometry") return bakedGeometry(*baked);
    const auto surface = baked->surface();
    if (!surface) return surface.issue();
    const glm::ivec2 size(baked->manifest().surface_size);
    report_ = {{"input", input_.string()}, {"kind", "map"}, {"map", map_}};
    if (map_ == "normal") return pictureFromSlice(surface->normal, size);
    if (map_ == "diffuse") return pictureFromSlice(surface->diffuse, size);
    if (map_ == "specular") {
      std::vector<glm::vec3> values;
      for (const glm::vec2& s : surface->specular) values.emplace_back(s, 0);
      return pictureFromSlice(values, size);
    }
    return Issue{issue_id::kOption, Severity::kError, "--map " + map_,
                 "this bake has " + bakedMapNames(baked->manifest())};
  }

  static std::string bakedMapNames(const BakeManifest& m) {
    std::string names = "normal, diffuse, specular, geometry";
    for (const glm::ivec2& size : m.vdims)
      names += ", vdim.latlong:" + std::to_string(size.x) + "x" + std::to_string(size.y);
    for (const int side : m.concentric_vdims) names += ", vdim.concentric:" + std::to_string(side);
    return names;
  }

  // Positions over p, or the cells of an indirection map, one per view.
  Result<Picture> bakedGeometry(const BakedOutput& baked) {
    const BakeManifest& m = baked.manifest();
    report_ = {{"input", input_.string()}, {"kind", "map"}, {"map", map_}};
    if (map_ == "geometry") {
      const auto texels = baked.geometry();
      if (!texels) return texels.issue();
      return mosaic<glm::vec4>(*texels, m.geometry_size, 1,
                               [](const glm::vec4& v) { return glm::vec4(glm::vec3(v), 1); });
    }
    for (const glm::ivec2& size : m.vdims) {
      if (map_ != "vdim.latlong:" + std::to_string(size.x) + "x" + std::to_string(size.y)) continue;
      const auto cells = baked.vdim(size.x, size.y);
      if (!cells) return cells.issue();
      return mosaic<glm::vec2>(*cells, m.size, size.y, [](const glm::vec2& v) { return glm::vec4(v, 0, 1); });
    }
    for (const int side : m.concentric_vdims) {
      if (map_ != "vdim.concentric:" + std::to_string(side)) continue;
      const auto cells = baked.concentricVdim(side);
      if (!cells) return cells.issue();
      return mosaic<float>(*cells, m.size, side, [](float z) { return glm::vec4(z, z, z, 1); });
    }
    return Issue{issue_id::kOption, Severity::kError, "--map " + map_, "this bake has " + bakedMapNames(m)};
  }

  std::filesystem::path input_, output_;
  std::string light_ = "30,0", view_ = "0,0", domain_ = "reference", lookup_ = "default", map_;
  double lambda_ = 0;
  int side_ = 0;
  Json report_;
};

}  // namespace

std::unique_ptr<Command> makeExtractCommand() {
  return std::make_unique<ExtractCommand>();
}

}  // namespace loden::importer
