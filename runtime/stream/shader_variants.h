// Every shader program that can exist, in one list: a program that no row allows is never compiled.
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

// What a material asks of a shader.
struct MaterialVariant {
  bool near = false;  // there is a near term
  uint8_t bands = 0;  // neither: the program shades no Loden material
  Lookup lookup = Lookup::kNone;
  Visibility visibility = Visibility::kNone;  // of the near term
  bool nearest_tables = false;                // tables of bands are read at the nearest sampled pair
  uint8_t first_unit = 0;                     // texture unit that the material's begin at
  uint8_t shadow_quads = 0;                   // of the shadow map; 0 unless visibility is kMap
  // How many bands' textures are bound, of a variant that narrowed() left without some of what the material
  // has; 0: as many as it shades.
  uint8_t bound_bands = 0;
  bool height_field = false;  // the lookup's geometry is one: R16 heights, p = P.xy
  bool indirect = false;      // the near term has light that comes by way of the tile
  bool shadesMaterial() const { return near || bands > 0; }
  friend bool operator==(const MaterialVariant&, const MaterialVariant&) = default;
};

// A cooked near term replaces the flat band, so that one coarser band stands beside it.
inline constexpr size_t kMostNearBands = 2;

// One row: two entry files and the material variants they may be built for.
struct ProgramRow {
  std::string_view name;
  std::string_view vertex, fragment;  // file names in shaders/; an empty fragment: depth only
  std::string_view defines[3];        // more defines, "NAME VALUE", or empty
  bool none = false;                  // may be built without a Loden material
  bool material = false;              // for materials, of a near term, bands or both
  bool relief = false;                // only for variants whose lookup finds a depth
  bool march = false;                 // only for near terms of height fields, in marchVariant's form
};

inline constexpr std::string_view kParallaxDepth = "SCENE_PARALLAX_DEPTH 1";
inline constexpr std::string_view kFollowSurface = "LODEN_FOLLOW_SURFACE 1";  // curved meshes, stretched UVs

// Peers of the lookup in height fields, for comparison.
inline constexpr std::string_view kParallaxOcclusion = "SCENE_PARALLAX_OCCLUSION 1";

inline constexpr std::string_view kHeat = "SCENE_HEAT 1";  // costs in place of looks
inline constexpr std::string_view kCountFetches = "LODEN_COUNT_FETCHES 1";

inline constexpr std::string_view kBase = "SCENE_BASE 1";  // glTF's own material

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
// The variant for draws within that range: without the near term where its window is closed all over it,
// without bands where it alone is open, without a lookup where nothing is read at p, and with the fast ones
// where the default ones spend no more. It draws the same; the same textures and uniform block are bound as
// for the material's own variant.
MaterialVariant narrowed(const MaterialVariant& variant, const Material& skeleton, LambdaRange range);

// The variant that parallax occlusion mapping draws a material with: its near term without cast shadows,
// indirect light and bands. None: it has no near term, or is no height field. Texture units and uniform block
// stay.
std::optional<MaterialVariant> marchVariant(const MaterialVariant& variant);

// Texture units that the material's textures take, from its first on (shaders/loden_shared.h).
int unitsOf(const MaterialVariant& variant);

// A row by name; null if there is none.
const ProgramRow* findProgramRow(std::string_view name);
bool rowAllows(const ProgramRow& row, const MaterialVariant& variant);
// All variants that the row allows, for compiling every one of them in a test.
std::vector<MaterialVariant> rowVariants(const ProgramRow& row);
// "LODEN_BANDS 4", "LODEN_LOOKUP_DEFAULT 1" ...: what follows `#define`.
std::vector<std::string> variantDefines(const MaterialVariant& variant);
// "near-bands1-default-shadows-fast"
std::string variantName(const MaterialVariant& variant);

}  // namespace loden::runtime
