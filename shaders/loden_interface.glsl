// What the library reads: one uniform block and its textures. A renderer binds these (units in
// loden_shared.h) and defines nothing else.

#ifdef VULKAN
#define LODEN_BINDING(n) layout(set = LODEN_DESCRIPTOR_SET, binding = LODEN_FIRST_UNIT + n)
#define LODEN_BLOCK(n) layout(std140, set = LODEN_DESCRIPTOR_SET, binding = 32 + n)
#else
#define LODEN_BINDING(n) layout(binding = LODEN_FIRST_UNIT + n)
#define LODEN_BLOCK(n) layout(std140, binding = n)
#endif

// LODEN_COUNT(unit, n) stands beside n texture instructions on a unit. An instrumented renderer may define
// its own.
#ifndef LODEN_COUNT
#ifdef LODEN_COUNT_FETCHES
int loden_fetches = 0;  // texture instructions issued by this invocation
#define LODEN_COUNT(unit, n) (loden_fetches += (n))
#else
#define LODEN_COUNT(unit, n)
#endif
#endif

LODEN_BLOCK(LODEN_BLOCK_MATERIAL) uniform LodenMaterialBlock {
  LodenMaterialData loden_material;
};

#ifdef LODEN_BANDS
LODEN_BINDING(LODEN_UNIT_WEIGHTS) uniform sampler2DArray loden_weights[LODEN_BANDS];      // repeat, trilinear
LODEN_BINDING(LODEN_UNIT_TABLE(LODEN_BANDS)) uniform sampler3D loden_table[LODEN_BANDS];  // clamp, linear
LODEN_BINDING(LODEN_UNIT_ENVIRONMENT(LODEN_BANDS))
uniform sampler3D loden_environment[LODEN_BANDS];  // clamp, linear
#endif
#if defined(LODEN_TABLES_NEAREST)
LODEN_BINDING(LODEN_UNIT_NEAREST_LIGHT) uniform usampler2D loden_nearest_light;
LODEN_BINDING(LODEN_UNIT_NEAREST_VIEW) uniform usampler2D loden_nearest_view;
#endif
// material/model/packed_geometry.h
#ifdef LODEN_HEIGHT_FIELD
LODEN_BINDING(LODEN_UNIT_GEOMETRY) uniform sampler2D loden_height;  // R16: 1 + z / range; repeat, linear
#else
LODEN_BINDING(LODEN_UNIT_GEOMETRY) uniform usampler2D loden_geometry;  // R32UI; repeat
#endif
LODEN_BINDING(LODEN_UNIT_VDIM_DEPTH) uniform sampler2DArray loden_vdim_depth;  // repeat
LODEN_BINDING(LODEN_UNIT_VDIM_VOLUME) uniform sampler3D loden_vdim_volume;     // nearest
#ifdef LODEN_LOOKUP_PAPER
LODEN_BINDING(LODEN_UNIT_PAPER_REFERENCE) uniform sampler2DArray loden_paper_reference;  // nearest
LODEN_BINDING(LODEN_UNIT_PAPER_PACKED) uniform sampler2DArray loden_paper_packed;        // repeat, linear
#endif
#if defined(LODEN_BOUND_BANDS)
#define LODEN_BANDS_OR_NONE LODEN_BOUND_BANDS
#elif defined(LODEN_BANDS)
#define LODEN_BANDS_OR_NONE LODEN_BANDS
#else
#define LODEN_BANDS_OR_NONE 0
#endif
#ifdef LODEN_NEAR
LODEN_BINDING(LODEN_UNIT_NORMAL(LODEN_BANDS_OR_NONE))
uniform sampler2DArray loden_normal;  // repeat, trilinear, as all three
LODEN_BINDING(LODEN_UNIT_COLOR(LODEN_BANDS_OR_NONE)) uniform sampler2DArray loden_color;
LODEN_BINDING(LODEN_UNIT_AMBIENT(LODEN_BANDS_OR_NONE)) uniform sampler2DArray loden_ambient;
#endif
#ifdef LODEN_VISIBILITY_MAP
LODEN_BINDING(LODEN_UNIT_SHADOW(LODEN_BANDS_OR_NONE)) uniform sampler2DArray loden_shadow;  // as those three
LODEN_BINDING(LODEN_UNIT_SHADOW_TABLE(LODEN_BANDS_OR_NONE))
uniform sampler2DArray loden_shadow_table;  // clamp, linear
#endif
#ifdef LODEN_INDIRECT
LODEN_BINDING(LODEN_UNIT_INDIRECT(LODEN_BANDS_OR_NONE))
uniform sampler2DArray loden_indirect;  // as those three
#endif

#include "loden_types.glsl"

LodenPoint loden_point_default() {
  vec2 scale = loden_material.periods_per_length;
  return LodenPoint(loden_material.resident_lambda, 0.0, 0.0, true, mat2(0.0),
                    mat2(scale.x, 0.0, 0.0, scale.y), 1.0);
}
