// loden info X.loden
#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "importer/base/file_read.h"
#include "importer/cli/input_kind.h"
#include "importer/cli/output.h"
#include "material/asset/asset.h"
#include "material/base/issues.h"
#include "material/model/environment.h"
#include "material/model/leading_part.h"
#include "material/system/asset_io.h"

namespace loden::importer {
namespace {

using Json = nlohmann::ordered_json;

// A line of the report: a map, or what the runtime makes or keeps beside the maps.
struct Row {
  std::string name, format, extent;
  uint64_t raw_bytes = 0, stored_bytes = 0, gpu_bytes = 0;
};

std::string extentOf(const Texture& t) {
  return formatted("%dx%dx%d", t.width, t.height, t.depth) +
         (t.mips > 1 ? formatted(" %d mips", t.mips) : "");
}

// The runtime builds a first and a full atlas, with a packed copy of the geometry.
Row atlasRow(const Material& material) {
  const VdimAtlasSize size = material.atlas;
  return {"vdim atlas",
          "R8_UNORM",
          formatted("%dx%dx%d", size.texels, size.texels, size.directions * size.directions),
          0,
          0,
          residentAtlasBytes(material.geometry, size)};
}

// The leading part, which the runtime keeps beside the whole; its raw bytes are among those of the maps.
std::optional<Row> leadingRow(const AssetFile& file, const MaterialPart& part) {
  const Material& material = file.skeleton();
  const uint64_t stored_bytes = file.storedBytes(part, Share::kLead);
  if (part.kind == PartKind::kBand) {
    const Band& band = material.bands[size_t(part.band)];
    if (band.lead_quads == 0) return {};
    return Row{mapName(part, "lead"),
               "",
               formatted("%d of %d quads", band.lead_quads, band.quads()),
               0,
               stored_bytes,
               gpuBytes(leadOf(band))};
  }
  if (part.kind != PartKind::kSurface || material.surface->tail_mip == 0) return {};
  return Row{mapName(part, "tail"),
             "",
             formatted("mips from %d on", material.surface->tail_mip),
             0,
             stored_bytes,
             gpuBytes(leadOf(*material.surface))};
}

// The bytes on disk of a part stand at its first map.
std::vector<Row> rowsOf(const AssetFile& file) {
  const Material& material = file.skeleton();
  std::vector<Row> rows;
  for (const MaterialPart& part : materialParts(material)) {
    uint64_t stored_bytes = file.storedBytes(part);
    for (const auto& map : mapsOf(material, part)) {
      const Texture& texture = *map.texture;
      const uint64_t bytes = textureBytes(texture);
      rows.push_back({mapName(part, map.name), texelFormatName(texture.format), extentOf(texture), bytes,
                      std::exchange(stored_bytes, 0), part.kind == PartKind::kGeometry ? 0 : bytes});
    }
    // What the runtime makes of the maps.
    if (part.kind == PartKind::kBand)
      rows.back().gpu_bytes += environmentTableBytes(material.bands[size_t(part.band)]);
    if (part.kind == PartKind::kGeometry) rows.push_back(atlasRow(material));
    if (auto lead = leadingRow(file, part)) rows.push_back(*std::move(lead));
  }
  return rows;
}

Json bandJson(const Band& band, size_t index) {
  const Window& w = band.window;
  Json begins = Json::array(), ends = Json::array();
  for (const QuadLevels& levels : band.quad_levels)
    begins.push_back(levels.begin), ends.push_back(levels.end);
  return {{"band", index},
          {"domain", band.domain == Domain::kFlat ? "flat" : "reference"},
          {"layout", band.layout == TableLayout::kGrid ? "grid" : "nearest"},
          {"filter", band.filter == WeightFilter::kLinear ? "linear" : "nearest"},
          {"window", {w.in_begin, w.in_end, w.out_begin, w.out_end}},
          {"lambda_first", band.lambda_first},
          {"y_components", band.y_quads * 4},
          {"chroma_quads", band.chroma_quads},
          {"ratio", band.ratio},
          {"lead_quads", band.lead_quads},
          {"quad_begin", begins},
          {"quad_end", ends}};
}

// A level L needs every band whose window is open at some lambda >= L: what a file cut there still gives.
struct LevelBytes {
  int level = 0;
  uint64_t raw = 0, gpu = 0;
};

std::vector<LevelBytes> cumulativeBytes(const Material& material, const std::vector<Row>& rows) {
  uint64_t shared_raw = 0, shared_gpu = 0;
  for (const Row& row : rows)
    if (!row.name.starts_with("band")) shared_raw += row.raw_bytes, shared_gpu += row.gpu_bytes;
  std::vector<LevelBytes> levels;
  for (int level = static_cast<int>(material.lambda_max); level >= 0; --level) {
    LevelBytes bytes{level, shared_raw, shared_gpu};
    for (const Band& band : material.bands) {
      if (band.window.out_end <= static_cast<float>(level)) continue;
      // Mips above the level need not be there.
      const int skipped = std::clamp(static_cast<int>(std::floor(float(level) - band.lambda_first)), 0,
                                     band.weights.mips - 1);
      const Texture& w = band.weights;
      const uint64_t weights = textureBytes(w) - w.mipOffset(skipped);
      const uint64_t tables = textureBytes(band.table);
      bytes.raw += weights + tables;
      bytes.gpu += weights + tables + environmentTableBytes(band);
      if (band.lead_quads > 0) bytes.gpu += gpuBytes(leadOf(band));
    }
    levels.push_back(bytes);
  }
  return levels;
}

// What `loden cook` noted. The text is untrusted: what it lacks is left out, and what is none of cook's is
// shown as it is.
std::string cookedText(const std::string& meta_text) {
  if (meta_text.empty()) return {};
  const auto meta = Json::parse(meta_text, nullptr, false);
  try {
    const auto quoted = [&](const char* key) {
      return meta.at(key).dump();
    };  // no control character comes through
    std::string text = "\ncooked from " + quoted("input") + ", preset " + quoted("preset") + ", components " +
                       quoted("components");
    text += "\n";
    if (const auto error = meta.find("error"); error != meta.end())
      text += formatted("RMSE at the sampled directions: Y %.4f, Cb %.4f, Cr %.4f\n",
                        error->at("y").at("rmse").get<double>(), error->at("cb").at("rmse").get<double>(),
                        error->at("cr").at("rmse").get<double>());
    if (const auto one = meta.find("error_of_one_evaluation"); one != meta.end())
      text += formatted("  that is of four evaluations a texel; of one: Y %.4f\n",
                        one->at("y").at("rmse").get<double>());
    if (const auto near = meta.find("near"); near != meta.end()) {
      const auto visibility = near->at("visibility").get<std::string>();
      const std::string shadows = visibility == "none"  ? "no cast shadows"
                                  : visibility == "map" ? "shadows by their own map"
                                                        : "shadows by lookup " + visibility;
      text += "near term: lobe " + near->at("lobe").get<std::string>() + ", " + shadows;
      if (near->value("indirect", false)) text += ", light by way of the tile";
      if (const auto fade = near->find("fade"); fade != near->end())
        text +=
            formatted(", fades over lambda %g to %g", fade->at(0).get<double>(), fade->at(1).get<double>());
      text += "\n";
    }
    for (const Json& trial : meta.value("chroma", Json::array()))
      text += formatted("%d quads of the band for chroma: RMSE of RGB %.4f at lambda 1 to 3%s\n",
                        trial.at("quads").get<int>(), trial.at("rmse_rgb").get<double>(),
                        trial.at("kept").get<bool>() ? "" : ", not kept");
    for (const Json& level : meta.value("levels", Json::array())) {
      text += formatted("lambda %d: RMSE of RGB", level.at("level").get<int>());
      if (const auto near = level.find("near_rmse_rgb"); near != level.end())
        text += formatted(" %.4f by the near term,", near->get<double>());
      text += " by the bands with 1, 2 ... quads of the coarsest";
      for (const Json& rmse : level.at("quads_rmse_rgb")) text += formatted(" %.4f", rmse.get<double>());
      text += "\n";
    }
    if (const auto lookup = meta.find("lookup"); lookup != meta.end()) {
      for (const char* name : {"fast", "default"})
        text += formatted("lookup %-8s mean error %.3f texels, %.1f %% over one, %.1f fetches\n", name,
                          lookup->at(name).at("mean_texels").get<double>(),
                          100 * lookup->at(name).at("over_1_texel").get<double>(),
                          lookup->at(name).at("fetches").get<double>());
      for (const Json& trial : lookup->value("tried", Json::array()))
        text += formatted("  tried %2d x %-2d texels, %2d x %-2d directions: mean %.3f, %.1f %% over one%s\n",
                          trial.at("texels").get<int>(), trial.at("texels").get<int>(),
                          trial.at("directions").get<int>(), trial.at("directions").get<int>(),
                          trial.at("mean_texels").get<double>(), 100 * trial.at("over_1_texel").get<double>(),
                          trial.at("texels") == lookup->at("atlas_texels") &&
                                  trial.at("directions") == lookup->at("atlas_directions")
                              ? ", chosen"
                              : "");
    }
    if (meta.contains("trade")) text += "the trade that its goal measured: --format json\n";
    return text;
  } catch (const Json::exception&) {
    return "\nnotes: " + meta_text + "\n";
  }
}

class InfoCommand : public Command {
 public:
  std::string_view name() const override { return "info"; }
  std::string_view summary() const override { return "Show what an asset holds, and what each part costs"; }

  void declare(Options& options) override {
    options.path("asset", path_, "Asset, .loden; a broken one is shown as far as it can be read", true);
  }

  int run(const GlobalOptions& globals) override {
    if (const Status status = checkOpens(path_, Openable::kFileOrFolder); !status)
      return fail(status.issue());
    const InputKind kind = inputKind(path_);
    const auto wrong = [&](const char* text) {
      return fail({issue_id::kMagic, Severity::kError, path_.string(), text});
    };
    if (kind == InputKind::kGltf) return wrong("is a scene; `loden validate` looks at it and at its assets");
    if (kind == InputKind::kBakedOutput) return wrong("is a baked output; `loden cook` makes an asset of it");
    auto opened = openFileSource(path_);
    if (!opened) return fail(opened.issue());
    const std::shared_ptr<const ByteSource> source = std::move(*opened);
    std::vector<Issue> issues = inspectAsset(*source, path_.string());
    const auto file = AssetFile::open(source, path_.string());
    if (!file && exitCodeOfAll(issues) == kExitOk)  // it has changed since, or cannot be read any more
      issues.push_back(file.issue());
    const Result<std::string> meta = file ? file->loadMeta() : std::string();
    if (!meta && exitCodeOfAll(issues) == kExitOk) issues.push_back(meta.issue());
    const std::string notes = meta ? *meta : std::string();
    if (globals.json)
      printAsJson(source->size(), file, notes, issues);
    else
      printAsText(source->size(), file, notes, issues);
    return exitCodeOfAll(issues);
  }

 private:
  void printAsJson(uint64_t file_bytes, const Result<AssetFile>& file, const std::string& notes,
                   const std::vector<Issue>& issues) const {
    Json json{{"file", path_.string()}, {"file_bytes", file_bytes}, {"issues", Json::array()}};
    for (const Issue& issue : issues) json["issues"].push_back(issueJson(issue));
    if (file) describe(*file, notes, json);
    printJson("info", json);
  }

  static void describe(const AssetFile& file, const std::string& notes, Json& json) {
    const Material& m = file.skeleton();
    json.update({{"name", m.name},
                 {"mode", modeName(m.mode)},
                 {"side", m.side},
                 {"lambda_max", m.lambda_max},
                 {"cosine_included", m.cosine_included},
                 {"value_scale", m.value_scale},
                 {"aspect", m.aspect},
                 {"period", m.period > 0 ? Json(m.period) : Json()}});
    json["mean"] = {{"ka", m.mean.ka},
                    {"kd", m.mean.kd},
                    {"ks", m.mean.ks},
                    {"alpha", m.mean.alpha},
                    {"cb", m.mean.cb},
                    {"cr", m.mean.cr},
                    {"chroma", m.mean.chroma == MeanChroma::kRatio ? "ratio" : "constant"}};
    for (size_t b = 0; b < m.bands.size(); ++b) json["bands"].push_back(bandJson(m.bands[b], b));
    uint64_t raw = 0, gpu = 0;
    const std::vector<Row> rows = rowsOf(file);
    for (const Row& row : rows) {
      json["maps"].push_back({{"name", row.name},
                              {"format", row.format},
                              {"extent", row.extent},
                              {"raw_bytes", row.raw_bytes},
                              {"stored_bytes", row.stored_bytes},
                              {"gpu_bytes", row.gpu_bytes}});
      raw += row.raw_bytes;
      gpu += row.gpu_bytes;
    }
    json["raw_bytes"] = raw;
    json["gpu_bytes"] = gpu;
    for (const LevelBytes& level : cumulativeBytes(m, rows))
      json["levels"].push_back({{"level", level.level}, {"raw_bytes", level.raw}, {"gpu_bytes", level.gpu}});
    for (const ChunkInfo& chunk : file.chunks())
      json["chunks"].push_back({{"type", chunkName(chunk.type)},
                                {"critical", (chunk.flags & 1) != 0},
                                {"codec", chunk.codec},
                                {"offset", chunk.offset},
                                {"stored_bytes", chunk.stored_bytes},
                                {"raw_bytes", chunk.raw_bytes},
                                {"hash", formatted("%016llx", static_cast<unsigned long long>(chunk.hash))}});
    json["present_chunks"] = file.presentChunks();
    const auto meta = Json::parse(notes, nullptr, false);
    json["cook"] = meta.is_discarded() ? Json(notes) : meta;
  }

  void printAsText(uint64_t file_bytes, const Result<AssetFile>& file, const std::string& notes,
                   const std::vector<Issue>& issues) const {
    std::string text = formatted("%s: %s bytes on disk\n", path_.c_str(), withThousands(file_bytes).c_str());
    if (file) text += describedText(*file, notes);
    for (const Issue& issue : issues) text += issueText(issue) + "\n";
    printText(text);
  }

  static std::string describedText(const AssetFile& file, const std::string& notes) {
    const Material& m = file.skeleton();
    std::string text = formatted("%s: %s, %d x %d texels, lambda 0 to %g, %zu bands, value %s cos(theta_i)\n",
                                 m.name.c_str(), modeName(m.mode), m.side, m.side, m.lambda_max,
                                 m.bands.size(), m.cosine_included ? "with" : "without");
    if (m.aspect != 1) text += formatted("tile: period of 1 x %.4g\n", m.aspect);
    if (m.period > 0) text += formatted("tile: %.4g m long in x\n", m.period);
    text += formatted("mean: ka %.4f, kd %.4f, ks %.4f, alpha %.2f, Cb %.4f, Cr %.4f%s\n", m.mean.ka,
                      m.mean.kd, m.mean.ks, m.mean.alpha, m.mean.cb, m.mean.cr,
                      m.mean.chroma == MeanChroma::kRatio ? " (of Y)" : "");
    const std::vector<Row> rows = rowsOf(file);
    uint64_t raw = 0, gpu = 0;
    text += formatted("\n%-18s %-20s %-22s %12s %12s %12s\n", "map", "format", "extent", "raw", "on disk",
                      "on the GPU");
    for (const Row& row : rows) {
      text += formatted("%-18s %-20s %-22s %12s %12s %12s\n", row.name.c_str(), row.format.c_str(),
                        row.extent.c_str(), withThousands(row.raw_bytes).c_str(),
                        row.stored_bytes ? withThousands(row.stored_bytes).c_str() : "",
                        withThousands(row.gpu_bytes).c_str());
      raw += row.raw_bytes, gpu += row.gpu_bytes;
    }
    text += formatted("%-18s %-20s %-22s %12s %12s %12s\n\n", "total", "", "", withThousands(raw).c_str(), "",
                      withThousands(gpu).c_str());
    for (const LevelBytes& level : cumulativeBytes(m, rows))
      text += formatted("level %d and coarser: %s bytes raw, %s on the GPU\n", level.level,
                        withThousands(level.raw).c_str(), withThousands(level.gpu).c_str());
    return text + cookedText(notes);
  }

  std::filesystem::path path_;
};

}  // namespace

std::unique_ptr<Command> makeInfoCommand() {
  return std::make_unique<InfoCommand>();
}

}  // namespace loden::importer
