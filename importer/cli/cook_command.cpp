// loden cook INPUT -o X.loden
#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

#include "importer/btf/finite_source.h"
#include "importer/btf/measured/cropped_source.h"
#include "importer/btf/measured/measured.h"
#include "importer/cli/input_kind.h"
#include "importer/cli/interrupt.h"
#include "importer/cli/output.h"
#include "importer/cook/cook.h"
#include "importer/cook/meta.h"
#include "material/asset/asset.h"
#include "material/base/issues.h"
#include "material/model/leading_part.h"
#include "material/system/asset_io.h"

namespace loden::importer {
namespace {

class CookCommand : public Command {
 public:
  std::string_view name() const override { return "cook"; }
  std::string_view summary() const override {
    return "Fit a baked or measured BTF and write the asset that the runtime draws";
  }

  void declare(Options& options) override {
    options.path("input", input_, "Baked output, Bonn image folder, or UBO2014 .btf file", true);
    options.path("-o,--output", output_, "Asset to write, .loden", true);
    options.choice("--mode", mode_, {"fused", "lod", "surface"},
                   "fused: fine bands on the tile, coarse ones on the plane; lod: Ma et al. 2005; surface: "
                   "normal and diffuse map");
    options.choice("--preset", preset_, {"seed", "game", "reference"},
                   "seed: as published; game: 8 bit, small; reference: as exact as it gets");
    options.text(
        "--components", components_,
        "Y,CB,CR components of the bands; fused: of the coarse one, with --near band of the fine one, "
        "CB = CR for what a ratio to Y leaves; default: the preset's");
    options.choice("--near", near_, {"surface", "band"},
                   "fused, up close: the surface's own reflectance and shadows, or a band fitted to the BTF");
    options.choice("--visibility", visibility_, {"auto", "none", "fast", "default", "map"},
                   "Cast shadows of the surface: none, by the lookup towards the light, by a map of shadows, "
                   "which costs "
                   "least where there are many lights, or none or the lookup, what measures best");
    options.integer(
        "--levels", cook_.levels,
        "Levels of detail to keep, from the finest; fused: 1 is the flat map alone; 0: the preset's", 0, 16);
    options.integer("--crop", crop_,
                    "Of a measured BTF, only the middle N x N texels; 0: all, which must be a square", 0,
                    16384);
    options.flag("--fix-nonfinite", fix_nonfinite_,
                 "Repair values that are not finite from their neighbours, and say so");
    options.bytes("--max-bytes", cook_.max_bytes,
                  "Goal: at most this many bytes before compression, for example 600k");
    options.number("--target-rmse", cook_.target_rmse, "Goal: at most this error of Y, white = 1; 0: none");
    options.flag(
        "--explain", explain_,
        "Print the trade of bytes against error that a goal measured, as a table (* : none better in both)");
    options.footer("Example: loden cook out/pulli -o pulli.loden --max-bytes 600k");
  }

  int run(const GlobalOptions& globals) override {
    if (const Status status = parse(); !status) return fail(status.issue());
    cook_.threads = globals.threads;
    cook_.quiet = globals.quiet;
    const auto start = std::chrono::steady_clock::now();
    if (fix_nonfinite_) repairs_ = std::make_shared<RepairLog>();
    auto material = cookInput(globals);
    noteRepairs(globals, repairs_.get());  // of an input that is refused for something else, too
    if (!material) return fail(material.issue());
    if (!name_.empty()) material->name = name_;
    const Status written = [&] {
      const CommitScope commit;
      return writeAsset(*material, output_);
    }();
    if (!written) return fail(written.issue());
    print(globals, *material,
          std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    return kExitOk;
  }

 private:
  Status parse() {
    cook_.mode = mode_ == "lod" ? Mode::kLod : mode_ == "surface" ? Mode::kSurface : Mode::kFused;
    cook_.preset = preset_ == "seed"        ? Preset::kSeed
                   : preset_ == "reference" ? Preset::kReference
                                            : Preset::kGame;
    cook_.near = near_ == "band" ? Near::kBand : Near::kSurface;
    if (visibility_ != "auto")
      cook_.visibility = visibility_ == "fast"      ? Visibility::kFast
                         : visibility_ == "default" ? Visibility::kDefault
                         : visibility_ == "map"     ? Visibility::kMap
                                                    : Visibility::kNone;
    if (output_.extension() != ".loden")
      return Issue{issue_id::kOption, Severity::kError, "--output " + output_.string(), "must end in .loden"};
    if (!(cook_.target_rmse >= 0))
      return Issue{issue_id::kOption, Severity::kError, "--target-rmse", "must not be negative"};
    if (components_.empty()) return {};
    const auto numbers = parseNumbers("--components", components_, 3);
    if (!numbers) return numbers.issue();
    for (const double number : *numbers)
      if (number < 0 || number > 256 || number != static_cast<int>(number))
        return Issue{issue_id::kOption, Severity::kError, "--components",
                     "'" + components_ + "' is not three numbers from 0 to 256"};
    cook_.y_components = static_cast<int>((*numbers)[0]);
    cook_.cb_components = static_cast<int>((*numbers)[1]);
    cook_.cr_components = static_cast<int>((*numbers)[2]);
    return {};
  }

  // "builtin:pulli" and "tiles/pulli.glb" -> "pulli"; as names of assets are: UTF-8 without control
  // characters.
  static std::string nameOf(const std::string& tile) {
    constexpr std::string_view kBuiltin = "builtin:";
    using Json = nlohmann::ordered_json;
    const Json stem = std::filesystem::path(tile.starts_with(kBuiltin) ? tile.substr(kBuiltin.size()) : tile)
                          .stem()
                          .string();
    std::string name =
        Json::parse(stem.dump(-1, ' ', false, Json::error_handler_t::replace)).get<std::string>();
    std::replace_if(
        name.begin(), name.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, '_');
    return name;
  }

  Result<Material> cookInput(const GlobalOptions& globals) {
    if (inputKind(input_) == InputKind::kBakedOutput) {
      const auto baked = BakedOutput::open(input_, repairs_);
      if (!baked) return baked.issue();
      name_ = nameOf(baked->manifest().tile);
      if (crop_ > 0)
        return Issue{issue_id::kOption, Severity::kError, "--crop",
                     "is for measured BTFs; bake at a smaller --size"};
      return cook(*baked, cook_);
    }
    auto measured = openMeasured(input_);
    if (!measured) return measured.issue();
    name_ = nameOf((input_.has_filename() ? input_ : input_.parent_path()).string());
    if (const Status status = checkMeasured(**measured); !status) return status.issue();  // before it is read
    if (mode_ == "fused") note(globals, "no meso-geometry: cooking with --mode lod");
    if (cook_.mode == Mode::kFused) cook_.mode = Mode::kLod;
    note(globals, input_.string() + ": " + (*measured)->format());
    std::string cosine_note;
    const CosineFlag flag = (*measured)->cosineFlag();
    std::unique_ptr<BtfSource> finite = std::move(*measured);
    if (crop_ > 0) {
      auto cropped = croppedSource(std::move(finite), crop_);
      if (!cropped) return cropped.issue();
      finite = std::move(*cropped);
    }
    if (repairs_) finite = repairedSource(std::move(finite), repairs_);
    const auto source = withCosine(std::move(finite), flag, globals.threads, cosine_note);
    if (!source) return source.issue();
    note(globals, cosine_note);
    return cook(**source, cook_);
  }

  Status checkMeasured(const BtfSource& measured) const {
    const glm::ivec2 size = measured.size();
    if (cook_.mode == Mode::kSurface)
      return Issue{issue_id::kOption, Severity::kError, "--mode surface",
                   measured.name() + " has no meso-geometry to show; cook it with --mode lod"};
    if (crop_ == 0 && size.x != size.y)
      return Issue{issue_id::kOption, Severity::kError, measured.name(),
                   "is " + std::to_string(size.x) + " x " + std::to_string(size.y) +
                       " texels, and only squares can be cooked: --crop " +
                       std::to_string(std::min(size.x, size.y)) + " takes the middle of it"};
    return {};
  }

  void print(const GlobalOptions& globals, const Material& material, double seconds) const {
    const uint64_t file_bytes = std::filesystem::file_size(output_), raw_bytes = rawFileBytes(material);
    if (globals.json) {
      const auto meta = nlohmann::ordered_json::parse(material.meta_json, nullptr, false);
      printJson("cook", {{"input", input_.string()},
                         {"asset", output_.string()},
                         {"mode", modeName(material.mode)},
                         {"preset", preset_},
                         {"bands", material.bands.size()},
                         {"raw_bytes", raw_bytes},
                         {"file_bytes", file_bytes},
                         {"seconds", seconds},
                         {"repaired", repairsJson(repairs_.get())},
                         {"cook", meta.is_discarded() ? nlohmann::ordered_json() : meta}});
      return;
    }
    printText(formatted("%s: %s, %zu bands, %s bytes raw, %s on disk, %.1f s\n", output_.c_str(),
                        modeName(material.mode), material.bands.size(), withThousands(raw_bytes).c_str(),
                        withThousands(file_bytes).c_str(), seconds));
    if (globals.verbose) printText(material.meta_json + "\n");
    printError(material);
    if (explain_) printTrade(material);
  }

  static void printError(const Material& material) {
    const auto meta = nlohmann::ordered_json::parse(material.meta_json, nullptr, false);
    if (!meta.is_object() || !meta.contains("error")) return;
    const auto rmse = [&](const char* channel) { return meta["error"][channel].value("rmse", 0.0); };
    printText(
        formatted("RMSE at the sampled directions, white = 1: Y %.4f, Cb %.4f, Cr %.4f; %s components, %s "
                  "bytes on the GPU\n",
                  rmse("y"), rmse("cb"), rmse("cr"), meta.value("components", std::string()).c_str(),
                  withThousands(meta.value("gpu_bytes", uint64_t{0})).c_str()));
  }

  // '*' marks the candidates that no other one beats in both bytes and error.
  static void printTrade(const Material& material) {
    const auto meta = nlohmann::ordered_json::parse(material.meta_json, nullptr, false);
    if (!meta.is_object() || !meta.contains("trade")) {
      printText("no trade was measured: give --max-bytes or --target-rmse with --mode fused\n");
      return;
    }
    if (meta["trade"].front().value("surface_side", 0) > 0)
      return printText(nearTradeText(meta["trade"]) + visibilityText(material) + indirectText(meta) +
                       levelsText(material));
    std::string text =
        "trade, measured with shortened fits (the asset's own error stands above). phis: columns of the "
        "flat map's direction grid;\n"
        "flat x: its texels to one of the reference; geometry: texels per side of the geometry image\n";
    text += formatted("%12s %5s %6s %5s %9s %12s %10s\n", "Y components", "phis", "flat x", "bits",
                      "geometry", "bytes", "RMSE of Y");
    for (const auto& point : meta["trade"])
      text +=
          formatted("%12d %5d %6g %5d %9d %12s %10.6f%s\n", point.value("y_components", 0),
                    point.value("phis", 0), point.value("flat_scale", 0.0), point.value("bits", 0),
                    point.value("geometry_side", 0), withThousands(point.value("bytes", uint64_t{0})).c_str(),
                    point.value("rmse_y", 0.0), point.value("pareto", false) ? " *" : "");
    printText(text + levelsText(material));
  }

  static std::string nearTradeText(const nlohmann::ordered_json& trade) {
    std::string text =
        "trade, by the mean of four evaluations a texel, without the choice of visibility. near: texels per "
        "side "
        "of the near term's maps; geometry: of the geometry image;\ncoarse: components of the coarse band\n";
    text += formatted("%6s %9s %7s %12s %10s\n", "near", "geometry", "coarse", "bytes", "RMSE of Y");
    for (const auto& point : trade)
      text += formatted("%6d %9d %7d %12s %10.6f%s\n", point.value("surface_side", 0),
                        point.value("geometry_side", 0), point.value("coarse_components", 0),
                        withThousands(point.value("bytes", uint64_t{0})).c_str(), point.value("rmse_y", 0.0),
                        point.value("pareto", false) ? " *" : "");
    return text;
  }

  static std::string visibilityText(const Material& material) {
    const SurfaceMaps& maps = *material.surface;
    if (maps.visibility == Visibility::kMap)
      return formatted(
          "visibility: by a map of shadows, %s bytes: %d fetches a pixel and as many for each light; the "
          "lookup "
          "(--visibility auto) is sharper and takes no bytes\n",
          withThousands(gpuBytes(maps) - gpuBytes(withoutShadow(maps))).c_str(), maps.shadow.depth);
    return formatted(
        "visibility: %s; a lookup takes some 2 to 6 fetches for each light. With many lights a map of "
        "shadows "
        "pays "
        "(--visibility map): softer, 2 fetches a pixel and 2 for each light, no search\n",
        visibilityName(maps.visibility));
  }

  static std::string indirectText(const nlohmann::ordered_json& meta) {
    const auto near = meta.value("near", nlohmann::ordered_json::object());
    if (!near.contains("indirect_rmse_y")) return {};
    return formatted(
        "light by way of the tile: %s; RMSE of Y %.4f with it, %.4f without. It takes 2 fetches a pixel\n",
        near.value("indirect", false) ? "kept" : "left out", near["indirect_rmse_y"].value("with", 0.0),
        near["indirect_rmse_y"].value("without", 0.0));
  }

  // The goal's error is that of lambda 0, where the coarser levels are not read, so it cannot weigh them:
  // what they cost is said instead.
  static std::string levelsText(const Material& material) {
    if (material.bands.empty() || material.bands.back().domain == Domain::kFlat)
      return "levels: what shows up close alone\n";
    const Band& coarse = material.bands.back();
    uint64_t beyond = coarse.weights.data.size();
    beyond -= textureBytes(coarse.weights.format, uint64_t(coarse.weights.width),
                           uint64_t(coarse.weights.height), uint64_t(coarse.weights.depth), 1);
    return formatted(
        "levels: not part of the trade, as the error above is that of lambda 0. From lambda 1 on they cost "
        "%s bytes, from 2 on %s; "
        "--levels N keeps the N finest\n",
        withThousands(coarse.bytes()).c_str(), withThousands(beyond).c_str());
  }

  std::filesystem::path input_, output_;
  std::string mode_ = "fused", preset_ = "game", near_ = "surface", visibility_ = "auto", components_, name_;
  bool explain_ = false, fix_nonfinite_ = false;
  int crop_ = 0;
  std::shared_ptr<RepairLog> repairs_;
  CookOptions cook_;
};

}  // namespace

std::unique_ptr<Command> makeCookCommand() {
  return std::make_unique<CookCommand>();
}

}  // namespace loden::importer
