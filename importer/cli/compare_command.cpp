// loden compare REF TEST
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "importer/base/file_read.h"
#include "importer/btf/compare.h"
#include "importer/btf/measured/measured.h"
#include "importer/cli/input_kind.h"
#include "importer/cli/output.h"
#include "material/asset/asset.h"
#include "material/system/asset_io.h"
#include "material/system/threads.h"

namespace loden::importer {
namespace {

using Json = nlohmann::ordered_json;

Json channelJson(const ChannelError& e) {
  return {{"mse", e.mse}, {"rmse", e.rmse}, {"mae", e.mae}};
}

Json sumsJson(const ErrorSums& sums) {
  Json json{{"y", channelJson(sums.y())}, {"cb", channelJson(sums.cb())}, {"cr", channelJson(sums.cr())}};
  json["lab"] = {{"mean", sums.labMean()}, {"max", sums.labMax()}};
  json["psnr_db"] = sums.psnr();  // null if equal
  json["samples"] = sums.count();
  return json;
}

std::string sumsText(const std::string& title, const ErrorSums& sums) {
  std::string text = formatted("%-18s %11s %11s %11s\n", title.c_str(), "MSE", "RMSE", "MAE");
  const auto line = [&](const char* name, const ChannelError& e) {
    text += formatted("  %-16s %11.6g %11.6g %11.6g\n", name, e.mse, e.rmse, e.mae);
  };
  line("Y", sums.y());
  line("Cb", sums.cb());
  line("Cr", sums.cr());
  return text + formatted("  Lab (CIE76, D65) mean %.4f, max %.4f; PSNR %.2f dB\n", sums.labMean(),
                          sums.labMax(), sums.psnr());
}

class CompareCommand : public Command {
 public:
  std::string_view name() const override { return "compare"; }
  std::string_view summary() const override {
    return "Measure how far a material or picture is from another";
  }

  void declare(Options& options) override {
    options.path("reference", reference_, "Baked output, measured BTF, asset or picture", true);
    options.path("test", test_, "Asset or picture (or a baked output against a baked output)", true);
    options.choice("--lookup", lookup_, {"default", "fast", "paper", "quality", "none"}, "How assets find p");
    options.integer("--level", compare_.level,
                    "Level of detail: the reference is averaged over 2^N x 2^N texels", 0, 12);
    options.integer("--every", compare_.every, "Only every N-th view and light", 1, 1000);
    options.number("--fail", fail_, "Exit with 7 if the metric is worse than X", true);
    options.choice("--metric", metric_, {"rmse", "mae", "lab", "flip", "psnr"},
                   "What --fail looks at: rmse and mae of Y, mean Lab, mean FLIP, or PSNR (worse = below)");
    options.footer(
        "Pictures: integer formats are decoded from sRGB, EXR and HDR are linear. White Lambert = 1.\n"
        "FLIP of materials is the mean over one 2-D slice per view.");
  }

  int run(const GlobalOptions& globals) override {
    compare_.threads = globals.threads;
    compare_.quiet = globals.quiet;
    for (const auto& path : {reference_, test_})
      if (const Status status = checkOpens(path, Openable::kFileOrFolder); !status)
        return fail(status.issue());
    const bool pictures = inputKind(reference_) == InputKind::kPicture;
    if (pictures != (inputKind(test_) == InputKind::kPicture))
      return failUsage(
          "a picture can be compared with a picture only; `loden extract` makes one of a material");
    if (inputKind(reference_) == InputKind::kAsset && inputKind(test_) == InputKind::kBakedOutput)
      return failUsage("a baked output is the reference for an asset: name it first");
    return pictures ? runPictures(globals) : runMaterials(globals);
  }

 private:
  struct Loaded {
    std::optional<Material> material;
    std::optional<Evaluator> evaluator;
    std::unique_ptr<BtfSource> source;
  };

  int runPictures(const GlobalOptions& globals) {
    const auto reference = readPicture(reference_), test = readPicture(test_);
    if (!reference) return fail(reference.issue());
    if (!test) return fail(test.issue());
    const auto difference = comparePictures(*reference, *test);
    if (!difference) return fail(difference.issue());
    if (globals.json) {
      Json json = header("picture");
      json["all"] = sumsJson(difference->all);
      json["flip"] = {{"mean", difference->flip_mean}, {"max", difference->flip_max}};
      return finish(globals, json, difference->all, difference->flip_mean);
    }
    printText(sumsText("all pixels", difference->all) +
              formatted("  FLIP mean %.6f, max %.6f\n", difference->flip_mean, difference->flip_max));
    return finish(globals, {}, difference->all, difference->flip_mean);
  }

  int runMaterials(const GlobalOptions& globals) {
    Loaded reference, test;
    if (const Status status = loadBaked(reference_, reference, globals.threads); !status)
      return fail(status.issue());
    if (const Status status = loadBaked(test_, test, globals.threads); !status) return fail(status.issue());
    const DirectionSet directions = commonDirections(reference, test);
    if (const Status status = loadAsset(reference_, reference, directions, 0, globals); !status)
      return fail(status.issue());
    const int side = reference.source->size().x >> compare_.level;
    if (const Status status = loadAsset(test_, test, directions, side, globals); !status)
      return fail(status.issue());
    const auto difference = compareBtfs(*reference.source, *test.source, compare_);
    if (!difference) return fail(difference.issue());
    Json json = header("btf");
    if (!globals.json) {
      printDifference(*difference);
    } else {
      json["all"] = sumsJson(difference->all);
      json["theta_up_to_60"] = sumsJson(difference->low);
      json["theta_over_60"] = sumsJson(difference->high);
      const Spread& images = difference->image_rmse_y;
      json["images"] = {{"count", difference->images},
                        {"rmse_y_mean", images.mean},
                        {"rmse_y_min", images.min},
                        {"rmse_y_max", images.max}};
      json["flip"] = {{"mean", difference->flip_mean}};
    }
    return finish(globals, json, difference->all, difference->flip_mean);
  }

  static Status loadBaked(const std::filesystem::path& path, Loaded& loaded, int threads) {
    if (inputKind(path) == InputKind::kAsset) return {};
    if (inputKind(path) != InputKind::kBakedOutput) return loadMeasured(path, loaded, threads);
    auto baked = BakedOutput::open(path);
    if (!baked) return baked.issue();
    auto source = bakedSource(std::move(*baked));
    if (!source) return source.issue();
    loaded.source = std::move(*source);
    return {};
  }

  // With the light's cosine in its values, as the cook takes it.
  static Status loadMeasured(const std::filesystem::path& path, Loaded& loaded, int threads) {
    auto measured = openMeasured(path);
    if (!measured) return measured.issue();
    const glm::ivec2 size = (*measured)->size();
    if (size.x != size.y)
      return Issue{issue_id::kMeasured, Severity::kError, path.string(),
                   "is " + std::to_string(size.x) + " x " + std::to_string(size.y) +
                       " texels, and only squares can be compared; cut it to one"};
    const CosineFlag flag = (*measured)->cosineFlag();
    std::string note;
    auto source = withCosine(std::move(*measured), flag, threads, note);
    if (!source) return source.issue();
    loaded.source = std::move(*source);
    return {};
  }

  static DirectionSet commonDirections(const Loaded& reference, const Loaded& test) {
    if (reference.source) return reference.source->views();
    return test.source ? test.source->views() : bonn81Directions();
  }

  Status loadAsset(const std::filesystem::path& path, Loaded& loaded, const DirectionSet& directions,
                   int side, const GlobalOptions& globals) const {
    if (loaded.source) return {};
    auto material = readAsset(path);
    if (!material) return material.issue();
    loaded.material = std::move(*material);
    loaded.evaluator.emplace(*loaded.material, onThreads(globals.threads));
    const auto lookup = prepareLookup(*loaded.evaluator, lookupNamed(lookup_).value(), path);
    if (!lookup) return lookup.issue();
    const double lambda = side > 0 ? compare_.level : 0;  // the reference is averaged from full resolution
    loaded.source = materialSource(*loaded.evaluator,
                                   {side, lambda, *lookup, Domain::kReference, directions, directions});
    return {};
  }

  Json header(const char* kind) const {
    return {{"kind", kind},
            {"reference", reference_.string()},
            {"test", test_.string()},
            {"level", compare_.level},
            {"lookup", lookup_}};
  }

  static void printDifference(const BtfDifference& difference) {
    const Spread& images = difference.image_rmse_y;
    printText(sumsText("all", difference.all) + sumsText("theta <= 60", difference.low) +
              (difference.high.count() ? sumsText("theta > 60", difference.high) : "") +
              formatted("%d light-view images: RMSE of Y mean %.6f, min %.6f, max %.6f; FLIP mean %.6f\n",
                        difference.images, images.mean, images.min, images.max, difference.flip_mean));
  }

  int finish(const GlobalOptions& globals, Json json, const ErrorSums& sums, double flip_mean) const {
    const bool higher_is_better = metric_ == "psnr";
    const double value = metric_ == "rmse"   ? sums.y().rmse
                         : metric_ == "mae"  ? sums.y().mae
                         : metric_ == "lab"  ? sums.labMean()
                         : metric_ == "flip" ? flip_mean
                                             : sums.psnr();
    const bool failed =
        !std::isnan(fail_) && !(higher_is_better ? value >= fail_ : value <= fail_);  // NaN fails
    if (globals.json) {
      if (!std::isnan(fail_))
        json["fail"] = {{"metric", metric_}, {"limit", fail_}, {"value", value}, {"failed", failed}};
      printJson("compare", json);
    }
    if (failed)
      note(globals, formatted("difference found: %s is %g, the limit is %g", metric_.c_str(), value, fail_));
    return failed ? kExitDifference : kExitOk;
  }

  std::filesystem::path reference_, test_;
  std::string lookup_ = "default", metric_ = "rmse";
  double fail_ = std::numeric_limits<double>::quiet_NaN();
  CompareOptions compare_;
};

}  // namespace

std::unique_ptr<Command> makeCompareCommand() {
  return std::make_unique<CompareCommand>();
}

}  // namespace loden::importer
