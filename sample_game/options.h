// The command line of loden_walk.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>

#include "material/model/analytic_surface.h"
#include "runtime/frame/frame.h"

namespace loden::walk {

// How materials are drawn (option --mode).
enum class Mode {
  kFull,       // as Loden draws them
  kFallback,   // by glTF's own materials
  kNormalMap,  // assets of mode surface by a normal and a diffuse map alone, without their VDIM
  kPaper,      // by the published VDIM lookup, if the asset stores its map
  kNoLod,      // with lambda 0 everywhere
  kParallax,   // height fields by parallax occlusion mapping, as engines draw them
};

// What the command line asks for. An empty path or name means that the option was not given.
struct Options {
  // A .gltf or .glb file; or an asset (.loden), which is shown on a cloth, a sphere and a plane.
  std::filesystem::path scene;
  // Shown on `material` of the scene; without a scene, on an analytic surface.
  std::filesystem::path asset;
  std::string material;  // name of the scene's material that shows the asset; empty: its only one
  double period = 0;     // length of the tile along its x, metres; 0: the asset's, or kUsualPeriod
  double rotation = 0;   // of the tile on the surface, radians
  SurfaceKind surface = SurfaceKind::kPlane;
  // Camera file; empty: the scene's own camera, or the default of material/model/analytic_surface.h.
  std::filesystem::path camera;
  // Direction to the light of an analytic surface: theta from +z and phi, degrees. None: the environment if
  // there is one, else (30, 0).
  std::optional<glm::dvec2> light;
  std::filesystem::path environment;
  std::filesystem::path truth;  // ray traced picture from the first camera, to compare with
  std::string variant;          // of the scene's materials (KHR_materials_variants)
  std::string animation;        // name, number or "none"; empty: the first
  double time = 0;              // where in the animation the first frame is, seconds
  bool headless = false;
  glm::ivec2 size{800, 600};
  std::filesystem::path script;  // camera path
  int turntable = 0;             // frames of one turn around the middle of the scene; 0: no turntable
  int frames = 0;                // 0: as long as the window is open; one when headless
  std::filesystem::path capture, report, contact_sheet, film, shader_cache;
  double budget_mb = 64, upload_kb = 256;
  Mode mode = Mode::kFull;
  runtime::LambdaRule lambda_rule = runtime::LambdaRule::kFootprint;
  std::optional<float> lambda;
  bool parallax_depth = false;
  bool shell = false;
  bool stream = false;    // when headless: frames do not wait for the loading thread
  bool gl_debug = false;  // print the driver's messages
  bool quiet = false;
  bool doctor = false;  // print what OpenGL offers and stop
  bool json = false;    // print that as JSON
  std::string command;  // the command line as typed, for the report

  // Whether the walk shows an analytic surface, exactly as `loden trace` draws it.
  bool onSurface() const { return scene.empty(); }
};
// Whether the file's name is that of an asset.
bool isAsset(const std::filesystem::path& file);
const char* modeName(Mode mode);

struct ParsedOptions {
  Options options;
  // Set if the program shall end with it: help was shown, or the command line is wrong.
  std::optional<int> exit_code;
};
// Parses the command line. Prints help to stdout, and errors to stderr.
ParsedOptions parseOptions(int argc, char** argv);

}  // namespace loden::walk
