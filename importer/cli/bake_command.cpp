// loden bake TILE -o DIR
#include <algorithm>
#include <nlohmann/json.hpp>

#include "importer/bake/bake.h"
#include "importer/base/repair_log.h"
#include "importer/btf/baked_files.h"
#include "importer/btf/btf_source.h"
#include "importer/btf/measured/bonn_folder.h"
#include "importer/cli/output.h"
#include "importer/cli/tile_file_arguments.h"
#include "material/base/issues.h"

namespace loden::importer {
namespace {

Issue optionIssue(const std::string& option, const std::string& text) {
  return {issue_id::kOption, Severity::kError, option, text};
}

// "latlong:16x16" and "concentric:16".
Status parseVdim(const std::string& text, BakeOptions& bake) {
  if (text.starts_with("concentric:")) {
    int side = 0, used = 0;
    const std::string number = text.substr(11);
    if (std::sscanf(number.c_str(), "%d%n", &side, &used) != 1 || used != static_cast<int>(number.size()) ||
        side < 1 || side > 256)
      return optionIssue("--vdim", "'" + text + "' is not concentric:N with N from 1 to 256");
    bake.concentric_vdims.push_back(side);
    return {};
  }
  if (!text.starts_with("latlong:"))
    return optionIssue("--vdim", "'" + text + "' is neither latlong:ZxA nor concentric:N");
  const auto extent = parseExtent("--vdim", text.substr(8));
  if (!extent) return extent.issue();
  if (extent->x < 2 || extent->y < 2 || extent->x > 256 || extent->y > 256)
    return optionIssue("--vdim", "'" + text + "' must have 2 to 256 zeniths and azimuths");
  bake.vdims.push_back(*extent);
  return {};
}

Result<BakeMaps> parseMaps(const std::vector<std::string>& names) {
  BakeMaps maps{false, false, false, false};
  for (const std::string& name : names) {
    if (name == "btf")
      maps.btf = true;
    else if (name == "flat")
      maps.flat = true;
    else if (name == "vdim")
      maps.vdim = true;
    else if (name == "surface")
      maps.surface = true;
    else
      return optionIssue("--maps", "'" + name + "' is none of btf, flat, vdim, surface");
  }
  return maps;
}

class BakeCommand : public Command {
 public:
  std::string_view name() const override { return "bake"; }
  std::string_view summary() const override {
    return "Bake a tile: BTF, Flat-BTF, VDIM and surface maps into a folder";
  }

  void declare(Options& options) override {
    options.text("tile", tile_, builtinTileList() + ", or a .gltf, .glb or .obj file of one period", true);
    options.path("-o,--output", output_, "Folder to fill", true);
    options.integer("--size", bake_.size, "Texels per side of the reference plane", 4, 4096);
    options.integer("--flat-size", bake_.flat_size,
                    "Texels per side of the Flat-BTF; 0: as --size, or what the tile's charts need", 0, 4096);
    options.integer("--surface-size", bake_.surface_size,
                    "Texels per side of the surface's normal and reflectance; 0: twice --size", 0, 4096);
    options.integer(
        "--geometry-size", bake_.geometry_size,
        "Texels per side of the geometry image; 0: 128, or as --size if that is more, and twice as many for "
        "height fields that need them",
        0, 2048);
    options.text("--directions", directions_, "Sampled lights and views: bonn81, ubo151 or NxN (concentric)");
    options.texts("--vdim", vdims_,
                  "Indirection maps, with commas between: latlong:ZxA (p - x), concentric:N (depths on the "
                  "runtime's grid; no cook needs it, see extract)");
    options.integer("--supersample", bake_.supersample, "Samples per texel side", 1, 16);
    options.integer("--bounces", bake_.bounces, "Indirect light; 0: direct light and cast shadows", 0, 16);
    options.choice("--fill", fill_, {"push-pull", "harmonic", "nearest-view"},
                   "How texels that a view does not see are filled");
    options.choice("--texels", texels_, {"mean", "linear"},
                   "Flat-BTF texels: means, or fitted to the linear filter that reads them");
    options.texts("--maps", maps_, "What to bake: btf, flat, vdim, surface, with commas between");
    options.text("--period", period_,
                 "Length of the tile along x on the surface, with its unit: 2cm, 15mm, 0.3m. It is kept for "
                 "whoever lays the material out");
    tile_file_.declare(options);
    options.flag("--fix-nonfinite", fix_nonfinite_,
                 "Repair vertices whose values are not finite from their neighbours, and say so");
    options.flag("--resume", bake_.resume, "Keep what an interrupted bake has finished");
    options.choice("--layout", layout_, {"loden", "bonn"},
                   "bonn: also write the BTF as Bonn's image folder, into DIR/bonn");
    options.choice("--encoding", encoding_, {"jpg", "hdr", "exr"}, "Images of --layout bonn");
    options.text("--shard", shard_, "I/N: do every N-th view, from I = 0; N runs fill one folder");
    options.footer("Example: loden bake builtin:pulli -o out/pulli --size 64");
  }

  int run(const GlobalOptions& globals) override {
    if (const Status status = parse(); !status) return fail(status.issue());
    bake_.threads = globals.threads;
    bake_.quiet = globals.quiet;
    if (fix_nonfinite_) repairs_ = std::make_shared<RepairLog>();
    auto tile_options = tile_file_.parse();
    if (!tile_options) return fail(tile_options.issue());
    tile_options->repairs = repairs_;
    const auto tile = loadTile(tile_, *tile_options);
    noteRepairs(globals, repairs_.get());  // of a tile that is refused for something else, too
    if (!tile) return fail(tile.issue());
    noteWarnings(globals, tile->warnings);
    if (std::error_code error;
        !bake_.resume && bake_.shards == 1 && std::filesystem::exists(output_ / "bake.json", error))
      note(globals, output_.string() + ": the finished bake that stands here is replaced");
    const auto report = bake(*tile, tile_, output_, bake_);
    if (!report) return fail(report.issue());
    if (layout_ == "bonn")
      if (const Status status = writeBonn(globals); !status) return fail(status.issue());
    print(globals, *tile, *report);
    return kExitOk;
  }

 private:
  Status parse() {
    const auto directions = directionsByName(directions_);
    if (!directions)
      return optionIssue("--directions", "'" + directions_ + "' is none of bonn81, ubo151, NxN");
    bake_.directions = *directions;
    if (!period_.empty()) {
      const auto period = parseLength("--period", period_);
      if (!period) return period.issue();
      bake_.period = *period;
    }
    bake_.vdims.clear();
    for (const std::string& text : vdims_)
      if (const Status status = parseVdim(text, bake_); !status) return status;
    bake_.fill = fillByName(fill_).value_or(FillMethod::kPushPull);
    bake_.texels = texels_ == "linear" ? TexelMethod::kLinear : TexelMethod::kMean;
    const auto maps = parseMaps(maps_);
    if (!maps) return maps.issue();
    bake_.maps = *maps;
    int used = 0;
    if (std::sscanf(shard_.c_str(), "%d/%d%n", &bake_.shard, &bake_.shards, &used) != 2 ||
        used != static_cast<int>(shard_.size()) || bake_.shards < 1 || bake_.shard < 0 ||
        bake_.shard >= bake_.shards)
      return optionIssue("--shard", "'" + shard_ + "' is not I/N with 0 <= I < N");
    if (layout_ == "bonn" && !bake_.maps.btf)
      return optionIssue("--layout bonn", "needs the BTF; name btf in --maps, too");
    if (layout_ == "bonn" && bake_.shards > 1)
      return optionIssue(
          "--layout bonn",
          "needs the whole bake; bake the shards first, then once more with --resume and --layout bonn");
    return {};
  }

  // The folder gets its name when all of it is written.
  Status writeBonn(const GlobalOptions& globals) const {
    const std::filesystem::path folder = output_ / "bonn", partial = output_ / "bonn.part";
    auto baked = BakedOutput::open(output_);
    if (!baked) return baked.issue();
    const auto source = bakedSource(std::move(*baked));
    if (!source) return source.issue();
    std::error_code error;
    std::filesystem::remove_all(partial, error);
    const BonnEncoding encoding = encoding_ == "jpg"   ? BonnEncoding::kJpeg
                                  : encoding_ == "hdr" ? BonnEncoding::kHdr
                                                       : BonnEncoding::kExr;
    if (Status status = writeBonnFolder(**source, partial, encoding, globals.threads, globals.quiet); !status)
      return status;
    std::filesystem::remove_all(folder, error);
    std::filesystem::rename(partial, folder, error);
    if (error) return Issue{issue_id::kCannotWrite, Severity::kError, folder.string(), error.message()};
    return {};
  }

  void print(const GlobalOptions& globals, const Tile& tile, const BakeReport& report) const {
    if (globals.json) {
      auto warnings = nlohmann::ordered_json::array();
      for (const Issue& warning : tile.warnings) warnings.push_back(issueJson(warning));
      printJson("bake", {{"tile", tile_},
                         {"folder", output_.string()},
                         {"complete", report.complete},
                         {"triangles", tile.triangles.size()},
                         {"rays", report.rays},
                         {"misses", report.misses},
                         {"seconds", report.seconds},
                         {"repaired", repairsJson(repairs_.get())},
                         {"warnings", warnings}});
      return;
    }
    printText(formatted("%s: %s triangles, %s rays in %.1f s", output_.c_str(),
                        withThousands(tile.triangles.size()).c_str(), withThousands(report.rays).c_str(),
                        report.seconds) +
              (report.complete ? "\n" : "; other shards are still to come\n"));
    if (report.complete) printParameterization();
  }

  void printParameterization() const {
    const auto baked = BakedOutput::open(output_);
    if (!baked) return;
    const BakeManifest& m = baked->manifest();
    printText(
        formatted("parameterization: %d triangles flipped; area per texel: coefficient of variation %.3f, 5 "
                  "%% below %.3f and 5 %% above %.3f of the mean\n",
                  m.flipped_triangles, m.area_cv, m.area_p5, m.area_p95));
  }

  std::string tile_, directions_ = "bonn81", shard_ = "0/1", layout_ = "loden", encoding_ = "jpg",
                     fill_ = "push-pull", texels_ = "mean", period_;
  std::vector<std::string> vdims_{"latlong:16x16", "latlong:8x32"};
  std::vector<std::string> maps_{"btf", "flat", "vdim", "surface"};
  std::filesystem::path output_;
  TileFileArguments tile_file_;
  bool fix_nonfinite_ = false;
  std::shared_ptr<RepairLog> repairs_;
  BakeOptions bake_;
};

}  // namespace

std::unique_ptr<Command> makeBakeCommand() {
  return std::make_unique<BakeCommand>();
}

}  // namespace loden::importer
