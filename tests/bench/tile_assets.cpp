#include "tests/bench/tile_assets.h"

#include <algorithm>
#include <filesystem>
#include <optional>

#include "importer/cook/cook.h"
#include "importer/cook/goal.h"
#include "importer/cook/modes.h"
#include "importer/study/study.h"
#include "material/asset/asset.h"
#include "material/system/asset_io.h"
#include "tests/bench/geometry_peers.h"

namespace loden::bench {
namespace {

using importer::BakedOutput;
using importer::Preset;
using runtime::Device;

// What `make` cooks, or what an earlier run with the same folder cooked.
template <class Make>
Material kept(const std::filesystem::path& folder, const std::string& name, Make make) {
  if (folder.empty()) return make();
  const std::filesystem::path path = folder / (name + ".loden");
  if (std::filesystem::exists(path)) return require(readAsset(path));
  Material material = make();
  std::filesystem::create_directories(folder);
  if (const Status status = writeAsset(material, path); !status) fail(status.issue());
  return material;
}

Material cooked(const BakedOutput& baked, Mode mode, Preset preset,
                std::optional<Visibility> visibility = {}) {
  importer::CookOptions options;
  if (visibility) options.visibility = *visibility;
  options.mode = mode;
  options.preset = preset;
  options.quiet = true;
  return require(importer::cook(baked, options));
}

Material smallestFused(const BakedOutput& baked) {
  const auto source = require(importer::bakedSource(baked));
  const auto btf = require(importer::loadYcc(*source, 0));
  const importer::FusedPlan plan = importer::smallestPlan(baked.manifest().geometry_size);
  Material material =
      importer::fitFusedBands(*source, btf, require(importer::geometryOf(baked, plan.geometry_side)), plan, 0)
          .material;
  material.aspect = static_cast<float>(baked.manifest().aspect);
  return material;
}

}  // namespace

std::vector<TileRenderer> tileRenderers(const Device& device, const TileArguments& arguments,
                                        const std::string& tile, const BakedOutput& baked,
                                        const importer::TileTracer& tracer,
                                        std::shared_ptr<const glm::vec3> constant) {
  const std::string stem = std::filesystem::path(tile).stem().string();
  const auto asset = [&](const char* name, auto make) {
    return kept(arguments.assets, stem + "-" + name, make);
  };
  const Material surface = asset("surface", [&] { return cooked(baked, Mode::kSurface, Preset::kGame); });
  Material maps = surface;
  maps.surface->tail_mip = 0;  // other renderers hold no leading part beside the whole
  maps.surface->visibility = Visibility::kNone;
  Material without_geometry = maps;
  without_geometry.geometry = {};

  std::vector<TileRenderer> all;
  const auto add = [&](const char* name, const char* setting, const Material& material, Lookup lookup) {
    all.push_back(lodenRenderer(device, name, setting, material, lookup));
  };
  if (arguments.wants("constant colour"))
    all.push_back(constantRenderer(device, without_geometry, std::move(constant)));
  Material from_above = seenFromAbove(maps, tracer);
  from_above.geometry = {};
  add(kBaseRenderer, "diffuse, normal, specular at x", from_above, Lookup::kNone);
  if (baked.manifest().identity_parameterization) {
    const auto heights = std::make_shared<const HeightMap>(maps.geometry);
    const auto march = [&](const char* name, int steps, int bisections) {
      if (arguments.wants(name)) all.push_back(marchRenderer(device, name, steps, bisections, maps, heights));
    };
    march("parallax occlusion mapping", 8, 4);
    march("parallax occlusion mapping", 16, 5);
    march("relief mapping", 32, 6);
    if (arguments.wants("cone stepping")) all.push_back(coneRenderer(device, 16, maps));
    if (arguments.wants("parallax occlusion mapping in a shell"))
      all.push_back(shellRenderer(device, 16, 5, maps, heights));
  }
  // Charts are packed anew at each density, so that the parameters of several would not be those of the bake.
  const auto& charts = tracer.tile().charts;
  const bool one_chart = std::all_of(charts.begin(), charts.end(), [](uint16_t chart) { return chart == 1; });
  if (arguments.wants("displaced mesh") && one_chart)
    all.push_back(meshRenderer(device, importer::studyTileName(tile), maps));
  if (arguments.wants("Flat-BTF, as published")) {
    Material paper = asset("paper", [&] { return cooked(baked, Mode::kSurface, Preset::kSeed); });
    paper.geometry = {};
    paper.surface->tail_mip = 0;
    add("Flat-BTF, as published", "latlong 16x16, blended", paper, Lookup::kPaper);
  }
  const int size = baked.manifest().size;
  if (arguments.wants("full BTF table") && (size & (size - 1)) == 0)
    all.push_back(tableRenderer(device, without_geometry, baked));
  if (arguments.wants("LOD-BTF, as published"))
    add("LOD-BTF, as published", "8,2,2 components, 32 bit",
        asset("published", [&] { return cooked(baked, Mode::kLod, Preset::kSeed); }), Lookup::kNone);
  if (arguments.wants("Loden, lod"))
    add("Loden, lod", "16 components, 8 bit",
        asset("lod", [&] { return cooked(baked, Mode::kLod, Preset::kGame); }), Lookup::kNone);
  if (arguments.wants("Loden, surface")) {
    add("Loden, surface", "fast lookup", maps, Lookup::kFast);
    add("Loden, surface", "default lookup", maps, Lookup::kDefault);
  }
  if (arguments.wants("Loden, fused")) {
    const Material fused = asset("fused", [&] { return cooked(baked, Mode::kFused, Preset::kGame); });
    add("Loden, fused", "fast lookup", fused, Lookup::kFast);
    add("Loden, fused", "default lookup", fused, Lookup::kDefault);
    add("Loden, fused", "fast lookup, shadows by map",
        asset("mapped", [&] { return cooked(baked, Mode::kFused, Preset::kGame, Visibility::kMap); }),
        Lookup::kFast);
  }
  if (arguments.wants("Loden, smallest"))
    add("Loden, smallest", "bands alone, fast lookup",
        asset("smallest", [&] { return smallestFused(baked); }), Lookup::kFast);
  return all;
}

}  // namespace loden::bench
