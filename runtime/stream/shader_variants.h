// The list of every shader program that can exist. A program that no row allows is never compiled.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "material/eval/evaluate.h"
#include "material/model/material.h"

namespace loden::runtime {

// The properties of a material that its shader is compiled for.
struct MaterialVariant {
  bool near = false;  // the material has a near term
  // Number of bands; with no band and no near term the program shades no Loden material.
  uint8_t bands = 0;
  Lookup lookup = Lookup::kNone;
  Visibility visibility = Visibility::kNone;  // how the near term finds cast shadows
  // Bands' tables are read at the nearest sampled pair of directions, without interpolation.
  bool nearest_tables = false;
  uint8_t first_unit = 0;    // the first of the material's texture units
  uint8_t shadow_quads = 0;  // layers of the shadow map; 0 unless visibility is kMap
  // How many bands have their textures bound, in a variant from narrowed(), which may shade fewer bands than
  // the material has; 0: as many as it shades.
  uint8_t bound_bands = 0;
  bool height_field = false;  // the geometry is a height field: R16 heights, and p = P.xy
  bool indirect = false;      // the near term has the light that other parts of the tile reflect to p
  bool shadesMaterial() const { return near || bands > 0; }
  friend bool operator==(const MaterialVariant&, const MaterialVariant&) = default;
};

// The most bands of a cooked material that has a near term. The near term takes the place of the flat band,
// so that one coarser band is left beside it.
inline constexpr size_t kMostNearBands = 2;

// One row of the list: two GLSL entry files, and the material variants for which they may be compiled.
struct ProgramRow {
  std::string_view name;
  // File names in shaders/; an empty fragment: the program draws depth only.
  std::string_view vertex, fragment;
  std::string_view defines[3];  // additional defines, each "NAME VALUE" or empty
  bool none = false;            // may be compiled without a Loden material
  bool material = false;        // may be compiled for materials with a near term, bands or both
  bool relief = false;          // only for variants whose lookup finds a depth
  bool march = false;           // only for near terms of height fields, as marchVariant returns them
};

inline constexpr std::string_view kParallaxDepth = "SCENE_PARALLAX_DEPTH 1";
// For curved meshes and stretched UVs.
inline constexpr std::string_view kFollowSurface = "LODEN_FOLLOW_SURFACE 1";

// Parallax occlusion mapping in place of the VDIM look-up in height fields, for comparison.
inline constexpr std::string_view kParallaxOcclusion = "SCENE_PARALLAX_OCCLUSION 1";

inline constexpr std::string_view kHeat = "SCENE_HEAT 1";  // shows costs as colours
inline constexpr std::string_view kCountFetches = "LODEN_COUNT_FETCHES 1";

inline constexpr std::string_view kBase = "SCENE_BASE 1";  // shades glTF's own material

inline constexpr ProgramRow kProgramRows[] = {
    {"scene_depth", "scene_depth.vert.glsl", "", {}, true, false},
    {"scene_base", "scene_base.vert.glsl", "scene_base.frag.glsl", {kBase}, true, false},
    {"scene_sky", "scene_sky.vert.glsl", "scene_sky.frag.glsl", {}, true, false},
    {"scene_base_depth", "scene_base.vert.glsl", "scene_base_depth.frag.glsl", {kBase}, true, false},
    {"scene_forward", "scene_forward.vert.glsl", "scene_forward.frag.glsl", {}, false, true},
    {"scene_forward_curved",
     "scene_forward.vert.glsl",
     "scene_forward.frag.glsl",
     {kFollowSurface},
     false,
     true,
     true},
    {"scene_forward_depth",
     "scene_forward.vert.glsl",
     "scene_forward.frag.glsl",
     {kParallaxDepth},
     false,
     true,
     true},
    {"scene_forward_depth_curved",
     "scene_forward.vert.glsl",
     "scene_forward.frag.glsl",
     {kParallaxDepth, kFollowSurface},
     false,
     true,
     true},
    {"scene_forward_march",
     "scene_forward.vert.glsl",
     "scene_forward.frag.glsl",
     {kParallaxOcclusion},
     false,
     true,
     true,
     true},
    {"scene_heat", "scene_forward.vert.glsl", "scene_forward.frag.glsl", {kHeat, kCountFetches}, false, true},
    {"scene_heat_curved",
     "scene_forward.vert.glsl",
     "scene_forward.frag.glsl",
     {kHeat, kCountFetches, kFollowSurface},
     false,
     true,
     true},
    {"scene_heat_march",
     "scene_forward.vert.glsl",
     "scene_forward.frag.glsl",
     {kHeat, kCountFetches, kParallaxOcclusion},
     false,
     true,
     true,
     true},
    {"scene_relief_depth",
     "scene_forward.vert.glsl",
     "scene_relief_depth.frag.glsl",
     {kParallaxDepth},
     false,
     true,
     true},
    {"scene_relief_depth_curved",
     "scene_forward.vert.glsl",
     "scene_relief_depth.frag.glsl",
     {kParallaxDepth, kFollowSurface},
     false,
     true,
     true},
};

// Whether the variant's lookup finds a depth below the reference plane.
bool hasRelief(const MaterialVariant& variant);

// The levels of detail that one draw asks for.
struct LambdaRange {
  float least, most;
};
// The cheapest variant that draws the same picture for draws whose levels of detail lie within `range`:
// without the near term if its weight is 0 all over the range, without bands if the near term alone counts
// there, without a lookup if nothing is read at p, and with the fast lookups where the default ones would
// take no more steps. Textures and uniform block are bound as for the material's own variant.
MaterialVariant narrowed(const MaterialVariant& variant, const Material& skeleton, LambdaRange range);

// The variant for drawing a material by parallax occlusion mapping: its near term without cast shadows,
// indirect light and bands. Texture units and uniform block are those of the material's own variant. Nothing
// if the material has no near term or is no height field.
std::optional<MaterialVariant> marchVariant(const MaterialVariant& variant);

// The number of texture units that the material's textures take, counted from first_unit
// (shaders/loden_shared.h).
int unitsOf(const MaterialVariant& variant);

// A row by name; null if there is none.
const ProgramRow* findProgramRow(std::string_view name);
bool rowAllows(const ProgramRow& row, const MaterialVariant& variant);
// All variants that the row allows; a test compiles every one of them.
std::vector<MaterialVariant> rowVariants(const ProgramRow& row);
// The variant as the text that follows `#define`: "LODEN_BANDS 4", "LODEN_LOOKUP_DEFAULT 1" ...
std::vector<std::string> variantDefines(const MaterialVariant& variant);
// The variant's name for labels and messages: "near-bands1-default-shadows-fast".
std::string variantName(const MaterialVariant& variant);

}  // namespace loden::runtime
