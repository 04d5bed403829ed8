// The command line of loden_walk.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>

#include "material/model/analytic_surface.h"
#include "runtime/frame/frame.h"

namespace loden::walk {

enum class Mode {
  kFull,       // everything
  kFallback,   // glTF's own materials
  kNormalMap,  // surface assets without their VDIM: a normal and a diffuse map
  kPaper,      // the published VDIM lookup, where the asset stores one
  kNoLod,      // always lambda 0
  kParallax,   // height fields by parallax occlusion mapping, as engines draw them
};

struct Options {
  std::filesystem::path
      scene;  // .gltf or .glb; or an asset (.loden) to show on a cloth, a sphere and a plane
  std::filesystem::path asset;  // without a scene: on an analytic surface; with one: on `material`
  std::string material;         // of the scene, that wears the asset; empty: the only one
  double period = 0;            // metres along the tile's x on it; 0: as the asset says, or the usual
  double rotation = 0;          // radians, of the tile on it
  SurfaceKind surface = SurfaceKind::kPlane;
  std::filesystem::path
      camera;  // empty: the scene's own, or the default of material/model/analytic_surface.h
  std::optional<glm::dvec2>
      light;  // degrees theta, phi from +z; of the surface. None: (30, 0), or the environment
  std::filesystem::path environment;  // empty: none
  std::filesystem::path truth;        // picture to compare with, from the first camera; empty: none
  std::string variant;                // of the scene's materials; empty: none
  std::string animation;              // name, number or "none"; empty: the first
  double time = 0;                    // seconds into the animation at the first frame
  bool headless = false;
  glm::ivec2 size{800, 600};
  std::filesystem::path script;
  int turntable = 0;  // frames of one turn around the middle of the scene; 0: none
  int frames = 0;     // 0: as long as the window is open, one when headless
  std::filesystem::path capture, report, contact_sheet, film, shader_cache;  // empty: none
  double budget_mb = 64, upload_kb = 256;
  Mode mode = Mode::kFull;
  runtime::LambdaRule lambda_rule = runtime::LambdaRule::kFootprint;
  std::optional<float> lambda;
  bool parallax_depth = false;
  bool shell = false;
  bool stream = false;    // headless: do not wait for the loading thread
  bool gl_debug = false;  // the driver's messages
  bool quiet = false;
  bool doctor = false;  // only tell what OpenGL offers
  bool json = false;    // ... as JSON
  std::string command;  // as typed, for the report

  // Exactly what `loden trace` draws, and nothing else.
  bool onSurface() const { return scene.empty(); }
};
// Whether the file is an asset, by its name.
bool isAsset(const std::filesystem::path& file);
const char* modeName(Mode mode);

struct ParsedOptions {
  Options options;
  std::optional<int> exit_code;  // set if there is nothing more to do: help was shown, or the usage is wrong
};
// Prints help to stdout, and what is wrong to stderr.
ParsedOptions parseOptions(int argc, char** argv);

}  // namespace loden::walk
