#include "sample_game/options.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <map>

#include "material/base/version.h"
#include "material/model/directions.h"
#include "material/model/uv_survey.h"

namespace loden::walk {
namespace {

const std::map<std::string, Mode> kModes{
    {"full", Mode::kFull},   {"fallback", Mode::kFallback}, {"normal-map", Mode::kNormalMap},
    {"paper", Mode::kPaper}, {"no-lod", Mode::kNoLod},      {"parallax", Mode::kParallax}};
const std::map<std::string, runtime::LambdaRule> kLambdaRules{{"footprint", runtime::LambdaRule::kFootprint},
                                                              {"distance", runtime::LambdaRule::kDistance}};
const std::map<std::string, SurfaceKind> kSurfaces{
    {"plane", SurfaceKind::kPlane}, {"cylinder", SurfaceKind::kCylinder}, {"sphere", SurfaceKind::kSphere}};

constexpr int kMaxSide = 16384;

// One of the names; help shows them as they are typed.
template <class Value>
CLI::Validator oneOf(const std::map<std::string, Value>& names) {
  std::string list;
  for (const auto& [name, value] : names) list += (list.empty() ? "" : "|") + name;
  return CLI::CheckedTransformer(names).description("{" + list + "}");
}

// "WxH"; an empty string if it is one, else what is wrong.
std::string parseSize(const std::string& text, glm::ivec2& size) {
  char rest = 0;
  if (std::sscanf(text.c_str(), "%dx%d%c", &size.x, &size.y, &rest) != 2) return "must be WIDTHxHEIGHT";
  const bool fits = size.x >= 1 && size.y >= 1 && size.x <= kMaxSide && size.y <= kMaxSide;
  return fits ? "" : "must be 1 .. " + std::to_string(kMaxSide);
}

// "T,P" in degrees.
std::string parseLight(const std::string& text, std::optional<glm::dvec2>& light) {
  char rest = 0;
  glm::dvec2 angles(0);
  const bool two = std::sscanf(text.c_str(), "%lf,%lf%c", &angles.x, &angles.y, &rest) == 2;
  light = angles;
  return two && std::isfinite(angles.x + angles.y) ? "" : "must be THETA,PHI in degrees";
}

// A length with its unit.
std::string parsePeriod(const std::string& text, double& metres) {
  const auto length = lengthFromText(text.c_str());
  if (length) metres = *length;
  return length ? "" : "must be a length with its unit, as 2cm, 15mm or 0.3m";
}

// Options as they are typed, before they are of use.
struct Texts {
  std::string size, light, period;
  double rotation = 0;  // degrees
};

void addInput(CLI::App& app, Options& options, Texts& texts) {
  app.add_option("scene", options.scene,
                 "Scene to walk through (.gltf, .glb), or an asset to show on a cloth, a sphere and a plane "
                 "(.loden)");
  auto* asset = app.add_option("--asset", options.asset,
                               "Asset (.loden) that --material of the scene wears, without packing; without "
                               "a scene, shown on a surface as loden trace does");
  app.add_option("--material", options.material,
                 "The scene's material that wears --asset; default: its only one")
      ->type_name("NAME")
      ->needs(asset);
  app.add_option("--period", texts.period,
                 "Length of a tile there, as in 2cm; default: what the asset says of itself, else 4cm")
      ->type_name("LENGTH")
      ->check([&](const std::string& text) { return parsePeriod(text, options.period); });
  app.add_option("--rotation", texts.rotation, "Of the tile there, degrees")
      ->check(CLI::Range(-360.0, 360.0));
  app.add_option("--surface", options.surface, "What shows the asset")
      ->transform(oneOf(kSurfaces))
      ->type_name("NAME")
      ->default_str("plane")
      ->needs(asset);
  app.add_option("--light", texts.light, "Direction of the light on the surface: THETA,PHI in degrees")
      ->default_str("30,0")
      ->needs(asset)
      ->check([&](const std::string& text) { return parseLight(text, options.light); });
  app.add_option("--environment", options.environment,
                 "Light from all around: a lat-long panorama (.hdr); on a surface, instead of --light unless "
                 "that is given too");
  app.add_option("--variant", options.variant, "Of the materials, by name (KHR_materials_variants)")
      ->type_name("NAME");
  app.add_option("--animation", options.animation, "By name or number; none: as the nodes stand in the file")
      ->type_name("NAME")
      ->default_str("the first");
  app.add_option("--time", options.time, "Where the animation begins, seconds")->check(CLI::Range(0.0, 1e6));
  app.add_option("--camera", options.camera,
                 "Camera (JSON: position, target, up, fov_degrees); without one the scene's first, or one "
                 "that sees all of it");
  app.add_option(
      "--truth", options.truth,
      "Picture (PNG) to compare with in the window, ray traced from the same camera in pictures of "
      "the same proportions, as loden trace does");
  app.add_option("--script", options.script,
                 "Camera path (JSON: keyframes of t, position, target); without one the camera of a headless "
                 "walk stands still");
}

void addOutput(CLI::App& app, Options& options, Texts& texts) {
  app.add_flag("--headless", options.headless, "No window, and no display needed");
  app.add_option("--size", texts.size, "Picture size, WxH")
      ->default_str("800x600")
      ->check([&](const std::string& text) { return parseSize(text, options.size); });
  app.add_option("--frames", options.frames,
                 "Number of frames, over which the path is spread; without it one if headless, else until "
                 "the window is closed")
      ->check(CLI::Range(1, 1000000));
  app.add_option("--turntable", options.turntable, "N frames of one turn around the middle of what is shown")
      ->check(CLI::Range(2, 100000));
  app.add_option("--film", options.film,
                 "Headless: folder for one PNG per frame, and for film.mp4 if ffmpeg is installed; the path "
                 "at 30 frames a second, or what --frames or --turntable say");
  app.add_option("--capture", options.capture, "Folder for one PNG per frame");
  app.add_option("--contact-sheet", options.contact_sheet, "One PNG with frames from the whole walk");
  app.add_option("--report", options.report, "Times, bytes and counts per frame (JSON)");
  app.add_flag("--gl-debug", options.gl_debug, "A debug context: the driver's messages are printed");
  app.add_flag("-q,--quiet", options.quiet, "No progress");
  auto* doctor =
      app.add_flag("--doctor", options.doctor, "Only tell what OpenGL offers here and what it lacks");
  app.add_option("--format", options.json, "Of --doctor")
      ->transform(oneOf(std::map<std::string, bool>{{"text", false}, {"json", true}}))
      ->type_name("NAME")
      ->default_str("text")
      ->needs(doctor);
}

void addRuntime(CLI::App& app, Options& options) {
  app.add_option("--budget-mb", options.budget_mb, "GPU memory for materials and textures, MiB")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  app.add_option("--upload-kb", options.upload_kb, "Upload per frame, KiB")
      ->check(CLI::Range(0.0, 1e9))
      ->capture_default_str();
  app.add_option(
         "--mode", options.mode,
         "full: everything; fallback: glTF's own materials; normal-map: surface assets without their "
         "VDIM; paper: the published lookup, where stored; no-lod: always lambda 0; parallax: height fields "
         "by parallax occlusion mapping, without shadows in the tile, to compare with")
      ->transform(oneOf(kModes))
      ->type_name("NAME")
      ->default_str("full");
  app.add_option(
         "--lambda-rule", options.lambda_rule,
         "Level of detail by a pixel's footprint on the surface, or by its distance alone (Ma et al. 2005)")
      ->transform(oneOf(kLambdaRules))
      ->type_name("NAME")
      ->default_str("footprint");
  app.add_option("--lambda", options.lambda, "Level of detail everywhere, instead of either rule's")
      ->check(CLI::Range(0.0, 32.0));
  app.add_flag("--parallax-depth", options.parallax_depth,
               "Depth, shadows and lamps at the displaced surface");
  app.add_flag("--shell", options.shell,
               "The same, and meshes lie where a relief is lowest, so that it sticks out of silhouettes");
  app.add_flag("--stream", options.stream,
               "Headless: draw what is resident instead of waiting for all of it");
  app.add_option("--shader-cache", options.shader_cache, "Folder for compiled programs");
}

// What CLI11 cannot express; empty if all is well.
std::string contradiction(const Options& options) {
  if (options.doctor) return {};
  if (options.scene.empty() && options.asset.empty())
    return "name a scene (.gltf, .glb), an asset (.loden), or --asset";
  if (isAsset(options.scene) && !options.asset.empty())
    return options.scene.string() +
           " is an asset itself, and --asset another: name a scene for that to be "
           "on, or one of them";
  if (!options.scene.empty() && options.light) return "--light is for surfaces, not for scenes";
  if (options.onSurface() && (options.period > 0 || options.rotation != 0 || !options.material.empty()))
    return "--material, --period and --rotation are for scenes";
  if (options.turntable > 0 && !(options.script.empty() && options.camera.empty()))
    return "--turntable is a path of its own: leave --camera and --script out";
  if (!options.headless && !(options.capture.empty() && options.contact_sheet.empty()))
    return "--capture and --contact-sheet need --headless: a window's pixels depend on what covers it";
  if (!options.truth.empty() && options.headless) return "--truth is shown in the window alone";
  if (!options.truth.empty() && !(options.script.empty() && options.turntable == 0))
    return "--truth needs a camera that stands still";
  if (!options.camera.empty() && !options.script.empty()) return "--camera and --script exclude each other";
  return {};
}

}  // namespace

const char* modeName(Mode mode) {
  for (const auto& [name, value] : kModes)
    if (value == mode) return name.c_str();
  return "";
}

bool isAsset(const std::filesystem::path& file) {
  return file.extension() == ".loden";
}

ParsedOptions parseOptions(int argc, char** argv) {
  ParsedOptions parsed;
  for (int i = 0; i < argc; ++i) (parsed.options.command += i > 0 ? " " : "") += argv[i];
  Texts texts;
  CLI::App app("loden_walk: walks through a glTF scene with Loden materials", "loden_walk");
  app.set_version_flag("--version", "loden_walk " LODEN_VERSION);
  addInput(app, parsed.options, texts);
  addOutput(app, parsed.options, texts);
  addRuntime(app, parsed.options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    parsed.exit_code = app.exit(error) == 0 ? 0 : 1;
    return parsed;
  }
  parsed.options.rotation = texts.rotation * kPi / 180;
  if (!parsed.options.film.empty()) parsed.options.headless = true;
  if (const std::string wrong = contradiction(parsed.options); !wrong.empty()) {
    std::fprintf(stderr, "loden_walk: %s; see --help\n", wrong.c_str());
    parsed.exit_code = 1;
  }
  return parsed;
}

}  // namespace loden::walk
