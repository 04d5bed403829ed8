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
    options.text("--scale", scale_, "Repetitions per unit of texture coordinate, SX,SY");
    options.number("--rotation", rotation_, "Degrees, as in KHR_texture_transform");
    options.flag("--fit-fallback", pack_.fit_fallback,
                 "Replace the material's pbrMetallicRoughness, too, not only add one where none is");
    options.footer(
        "Run pack last: most glTF tools drop extensions that they do not know, some without a word.");
  }

  int run(const GlobalOptions& globals) override {
    const auto scale = parseNumbers("--scale", scale_, 2);
    if (!scale) return fail(scale.issue());
    pack_.scale = {(*scale)[0], (*scale)[1]};
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
                         {"files", files}});
    } else {
      printText(formatted("%s: material %d '%s' uses %s\n", pack_.output.c_str(), report->material,
                          pack_.material.c_str(), report->asset_reference.c_str()));
    }
    return kExitOk;
  }

 private:
  PackOptions pack_;
  std::string scale_ = "1,1";
  double rotation_ = 0;
};

}  // namespace

std::unique_ptr<Command> makePackCommand() {
  return std::make_unique<PackCommand>();
}

}  // namespace loden::importer
