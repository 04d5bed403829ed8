// loden trace TILE -o truth.exr
#include <nlohmann/json.hpp>

#include "importer/base/file_read.h"
#include "importer/cli/interrupt.h"
#include "importer/cli/output.h"
#include "importer/cli/tile_file_arguments.h"
#include "importer/trace/trace.h"
#include "material/base/issues.h"

namespace loden::importer {
namespace {

using Json = nlohmann::ordered_json;

Issue cameraIssue(const std::filesystem::path& path, const std::string& text) {
  return {issue_id::kCamera, Severity::kError, path.string(),
          text + R"(; write {"position":[x,y,z],"target":[x,y,z],"fov_degrees":40})"};
}

bool readVector(const Json& json, const char* key, glm::dvec3& value) {
  if (!json.contains(key)) return true;
  const Json& array = json[key];
  if (!array.is_array() || array.size() != 3) return false;
  for (int i = 0; i < 3; ++i) {
    if (!array[i].is_number()) return false;
    value[i] = array[i].get<double>();
  }
  return true;
}

Result<Camera> readCamera(const std::filesystem::path& path) {
  const auto text = readFile(path);
  if (!text) return text.issue();
  const Json json = Json::parse(*text, nullptr, false);
  if (!json.is_object()) return cameraIssue(path, "is no JSON object");
  Camera camera;
  for (const auto& [key, member] :
       {std::pair{"position", &camera.position}, {"target", &camera.target}, {"up", &camera.up}})
    if (!readVector(json, key, *member)) return cameraIssue(path, std::string(key) + " is not three numbers");
  if (json.contains("fov_degrees")) {
    if (!json["fov_degrees"].is_number()) return cameraIssue(path, "fov_degrees is no number");
    camera.fov_degrees = json["fov_degrees"].get<double>();
  }
  if (!(camera.fov_degrees > 0 && camera.fov_degrees < 180))
    return cameraIssue(path, "fov_degrees must be between 0 and 180");
  return camera;
}

Result<Panorama> readEnvironment(const std::filesystem::path& path) {
  const auto picture = readPicture(path);
  if (!picture) return picture.issue();
  Panorama panorama{picture->width, picture->height, {}};
  for (const glm::vec4& pixel : picture->pixels) panorama.pixels.emplace_back(pixel);
  return panorama;
}

class TraceCommand : public Command {
 public:
  std::string_view name() const override { return "trace"; }
  std::string_view summary() const override {
    return "Ray trace the tile itself on a surface: ground truth for pictures";
  }

  void declare(Options& options) override {
    options.text("tile", tile_, builtinTileList() + ", or a .gltf, .glb or .obj file of one period", true);
    options.path("-o,--output", output_, ".exr (linear RGBA), .hdr, .png or .jpg (sRGB)", true);
    options.choice("--surface", surface_, {"plane", "cylinder", "sphere"},
                   "What the tile covers; one period is 1/8 m");
    options.path("--camera", camera_, "JSON: position, target, up, fov_degrees; metres, z up");
    options.text(
        "--light", light_,
        "Direction towards the light, THETA,PHI in degrees from +z (30,0); white Lambert lit from above = 1");
    options.path("--environment", environment_,
                 "Light from all around: a lat-long panorama (.hdr, .exr), z up; instead of --light unless "
                 "that is given too");
    options.text("--size", size_, "Picture, WxH");
    options.integer("--spp", trace_.samples, "Samples per pixel, stratified over its area", 1, 65536);
    options.integer("--bounces", trace_.bounces, "Indirect light; 0: direct light and cast shadows", 0, 16);
    tile_file_.declare(options);
    options.footer("loden_walk --asset X.loden --surface S --camera FILE draws exactly the same view.");
  }

  int run(const GlobalOptions& globals) override {
    if (light_.empty() && environment_.empty()) light_ = "30,0";
    trace_.light.reset();
    if (!light_.empty()) {
      const auto light = parseDirection("--light", light_, DirectionRange::kSphere);
      if (!light) return fail(light.issue());
      trace_.light = *light;
    }
    if (!environment_.empty()) {
      auto environment = readEnvironment(environment_);
      if (!environment) return fail(environment.issue());
      trace_.environment = std::move(*environment);
    }
    if (const Status status = checkPictureName(output_); !status) return fail(status.issue());
    const auto size = parseExtent("--size", size_);
    if (!size) return fail(size.issue());
    if (!camera_.empty()) {
      const auto camera = readCamera(camera_);
      if (!camera) return fail(camera.issue());
      trace_.camera = *camera;
    }
    trace_.surface = *surfaceKindByName(surface_);
    trace_.width = size->x, trace_.height = size->y;
    trace_.threads = globals.threads;
    trace_.quiet = globals.quiet;
    const auto tile_options = tile_file_.parse();
    if (!tile_options) return fail(tile_options.issue());
    const auto tile = loadTile(tile_, *tile_options);
    if (!tile) return fail(tile.issue());
    noteWarnings(globals, tile->warnings);
    const auto picture = trace(*tile, trace_);
    if (!picture) return fail(picture.issue());
    const Status written = [&] {
      const CommitScope commit;
      return writePicture(*picture, output_);
    }();
    if (!written) return fail(written.issue());
    if (globals.json)
      printJson("trace", {{"tile", tile_},
                          {"surface", surface_},
                          {"output", output_.string()},
                          {"width", size->x},
                          {"height", size->y},
                          {"spp", trace_.samples},
                          {"bounces", trace_.bounces}});
    else
      printText(formatted("%s: %d x %d, %d samples per pixel\n", output_.c_str(), size->x, size->y,
                          trace_.samples));
    return kExitOk;
  }

 private:
  std::string tile_, surface_ = "plane", light_, size_ = "800x600";
  std::filesystem::path output_, camera_, environment_;
  TileFileArguments tile_file_;
  TraceOptions trace_;
};

}  // namespace

std::unique_ptr<Command> makeTraceCommand() {
  return std::make_unique<TraceCommand>();
}

}  // namespace loden::importer
