// loden pack SCENE.gltf --material NAME --asset X.loden -o OUT
#include <nlohmann/json.hpp>

#include "importer/cli/interrupt.h"
#include "importer/cli/output.h"
#include "importer/gltf/pack.h"
#include "material/model/directions.h"

namespace loden::importer {
namespace {

class PackCommand : public Command {
 public:
  std::string_view name() const override { return "pack"; }
  std::string_view summary() const override {
    return "Put a material into a glTF scene, keeping everything else";
  }

  void declare(Options& options) override {
    options.path("scene", pack_.scene, "Scene, .gltf or .glb", true);
    options.text("--material", pack_.material, "Name of the glTF material that gets the asset", true);
    options.path("--asset", pack_.asset, "Asset, .loden", true);
    options.path("-o,--output", pack_.output, "Scene to write, of the same kind", true);
    options.flag("--embed", pack_.embed, "Put the asset into the scene file instead of beside it");
    options.integer("--texcoord", pack_.tex_coord, "TEXCOORD_N to use", 0, 15);
    options.text("--period", period_,
                 "Length of a tile on the material's surfaces, as in 2cm, measured by their texture "
                 "coordinates; default: the asset's own (bake --period), else one tile per unit");
    options.text("--scale", scale_,
                 "Instead: repetitions per unit of texture coordinate, SX,SY or one for both");
    options.number("--rotation", rotation_, "Degrees, as in KHR_texture_transform");
    options.flag("--fit-fallback", pack_.fit_fallback,
                 "Replace the material's own look by the asset's colours, normals and sheen for viewers "
                 "without the extension");
    options.footer(
        "Run pack last: most glTF tools drop extensions that they do not know, some without a word.");
  }

  int run(const GlobalOptions& globals) override {
    if (const Status status = parse(); !status) return fail(status.issue());
    pack_.rotation = rotation_ * kPi / 180;
    const auto report = [&] {
      const CommitScope commit;
      return pack(pack_);
    }();
    if (!report) return fail(report.issue());
    if (globals.json) {
      nlohmann::ordered_json files = nlohmann::ordered_json::array();
      for (const auto& file : report->files) files.push_back(file.string());
      printJson("pack", {{"output", pack_.output.string()},
                         {"material", report->material},
                         {"asset", report->asset_reference},
                         {"fallback_fitted", report->fallback_fitted},
                         {"scale", {report->scale.x, report->scale.y}},
                         {"period", {report->period.x, report->period.y}},
                         {"uv_stretch", report->stretch},
                         {"uv_stretched_share", report->stretched_share},
                         {"remarks", report->remarks},
                         {"files", files}});
    } else {
      printText(formatted("%s: material %d '%s' uses %s%s\n", pack_.output.c_str(), report->material,
                          pack_.material.c_str(), report->asset_reference.c_str(),
                          tileText(report->period).c_str()));
    }
    for (const std::string& remark : report->remarks) note(globals, pack_.scene.string() + ": " + remark);
    return kExitOk;
  }

 private:
  Status parse() {
    if (!period_.empty()) {
      if (!scale_.empty())
        return Issue{issue_id::kOption, Severity::kError, "--period", "excludes --scale: give one of them"};
      const auto period = parseLength("--period", period_);
      if (!period) return period.issue();
      pack_.period = *period;
    }
    if (scale_.empty()) return {};
    const bool both_axes = scale_.find(',') == std::string::npos;
    const auto scale = parseNumbers("--scale", scale_, both_axes ? 1 : 2);
    if (!scale) return scale.issue();
    pack_.scale = glm::dvec2(scale->front(), scale->back());
    return {};
  }

  // How large a tile comes out; nothing if that is not known.
  static std::string tileText(const glm::dvec2& period) {
    if (!(period.x > 0)) return {};
    const double unit = period.x < 0.01 ? 1e-3 : period.x < 1 ? 1e-2 : 1;
    const char* name = period.x < 0.01 ? "mm" : period.x < 1 ? "cm" : "m";
    return formatted("; a tile is %.3g %s x %.3g %s there", period.x / unit, name, period.y / unit, name);
  }

  PackOptions pack_;
  std::string scale_, period_;
  double rotation_ = 0;
};

}  // namespace

std::unique_ptr<Command> makePackCommand() {
  return std::make_unique<PackCommand>();
}

}  // namespace loden::importer
