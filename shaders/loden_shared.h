// Shared by C++ and GLSL: limits, texture bindings and the material's uniform block. Names beginning with
// LODEN_ are the same on both sides; a GL test asks the driver for every offset.
#ifndef LODEN_SHARED_H
#define LODEN_SHARED_H

#define LODEN_MAX_BANDS \
  8  // that one shader reads; files may hold more (LODEN limits in material/asset/asset.h)
#define LODEN_MAX_QUADS 16        // of one band
#define LODEN_MAX_SHADOW_QUADS 2  // of a shadow map

#define LODEN_MAX_CURVATURE 1.0  // of a reference surface that the lookup follows, per tile length

// How a material answers to light from all around (material/model/environment.h).
#define LODEN_ENVIRONMENT_BASIS 6   // functions over the hemisphere
#define LODEN_ENVIRONMENT_THETAS 6  // views of the mean

// Texture units, from LODEN_FIRST_UNIT on; `bands` is the variant's LODEN_BANDS, at which the arrays of
// weights, tables and environment tables end (0 without bands); the near term's maps come behind.
#ifndef LODEN_FIRST_UNIT
#define LODEN_FIRST_UNIT 0
#endif
#define LODEN_UNIT_GEOMETRY 0
#define LODEN_UNIT_VDIM_DEPTH 1
#define LODEN_UNIT_VDIM_VOLUME 2
#define LODEN_UNIT_NEAREST_LIGHT 3
#define LODEN_UNIT_NEAREST_VIEW 4
#define LODEN_UNIT_PAPER_REFERENCE 3  // the paper's VDIM and nearest tables never meet in one variant
#define LODEN_UNIT_PAPER_PACKED 4
#define LODEN_UNIT_WEIGHTS 5
#define LODEN_UNIT_TABLE(bands) (5 + (bands))
#define LODEN_UNIT_ENVIRONMENT(bands) (5 + 2 * (bands))
#define LODEN_UNIT_NORMAL(bands) (5 + 3 * (bands))
#define LODEN_UNIT_COLOR(bands) (6 + 3 * (bands))
#define LODEN_UNIT_AMBIENT(bands) (7 + 3 * (bands))
#define LODEN_UNIT_SHADOW(bands) (8 + 3 * (bands))
#define LODEN_UNIT_SHADOW_TABLE(bands) (9 + 3 * (bands))
#define LODEN_UNIT_INDIRECT(bands) (10 + 3 * (bands))
#define LODEN_UNITS(bands) (5 + 3 * (bands))  // that a variant takes; 3 to 6 more with the near term
#define LODEN_MAX_UNITS (3 + LODEN_UNITS(LODEN_MAX_BANDS))

#define LODEN_BLOCK_MATERIAL 0    // uniform block binding
#define LODEN_BLOCK_FIRST_FREE 1  // and up belong to the renderer

// Bits of LodenBandData.bits
#define LODEN_BAND_FLAT 1    // weights are read at p, else at x
#define LODEN_BAND_LINEAR 2  // filtered weights, else nearest
#define LODEN_BAND_RATIO 4   // one more layer of weights: Cb/Y and Cr/Y
// Bits of LodenMaterialData.bits
#define LODEN_MEAN_RATIO 1       // the mean's chroma is a multiple of its Y
#define LODEN_COSINE_INCLUDED 2  // values contain cos(theta_i)
#define LODEN_CLAMP_LAMBDA 8     // mode lod: beyond the last level the last level stays (LBTF 3.4, step 2)
#define LODEN_GGX 16             // the near term's lobe is GGX, else Phong

#ifdef __cplusplus
#include <glm/glm.hpp>
namespace loden {
using vec2 = glm::vec2;
using vec3 = glm::vec3;
using vec4 = glm::vec4;
#endif

// std140: members come in groups of 16 bytes, so that both languages agree on every offset.
struct LodenBandData {
  vec4 window;  // in_begin, 1 / (in_end - in_begin), out_end, 1 / (out_end - out_begin)

  float lambda_first;  // of mip 0 of the weights
  float last_mip;
  float side;             // texels of mip 0
  float per_table_depth;  // 1 / slices of the table

  vec2 grid;      // thetas, phis of the table; of nearest tables: of the views for the environment
  vec2 per_grid;  // 1 / thetas^2, 1 / phis

  int bits;  // LODEN_BAND_...
  int y_quads;
  int chroma_quads;
  int ratio_layer;  // of the weights

  vec4 quad_scale[LODEN_MAX_QUADS];      // per quad of y and chroma
  vec4 quad_begin[LODEN_MAX_QUADS / 4];  // lambda up to which it adds nothing; four quads each
  vec4 quad_end[LODEN_MAX_QUADS / 4];    // lambda from which on it adds nothing; likewise

  vec2 ratio_scale;
  float rest_share;  // of what quads from first_rest on add, which quad_scale holds already
  float first_rest;
};

struct LodenMaterialData {
  int bits;               // LODEN_MEAN_RATIO ...
  int geometry_resident;  // 1 if the geometry image and its atlas are
  int atlas_texels;       // per side
  int atlas_directions;   // per side

  vec4 mean;  // ka, kd, ks, alpha

  vec2 mean_chroma;       // cb, cr
  vec2 environment_unit;  // EnvironmentMean::unit

  vec4 theta_max;  // radians, cosine, sine, 1 / radians

  vec3 geometry_range;  // tile periods
  float geometry_side;  // texels

  vec2 paper_range;  // of the paper's VDIM
  vec2 paper_size;   // zeniths, azimuths

  float value_scale;  // of what loden_evaluate and loden_evaluate_environment return
  float side;         // reference texels
  float lambda_max;
  float resident_lambda;  // the smallest: the shader clamps to it

  float specular_scale;  // of the near term's maps
  float surface_lambda;  // of mip 0 of what is resident of them
  float ambient_lambda;  // of mip 0 of the ambient map
  float near_end;        // w(lambda) is 0 from here on

  float near_slope;         // 1 / (near_end - where it begins to fall)
  float shadow_side;        // texels per side of the shadow map's table
  vec2 periods_per_length;  // tile coordinates to a tile length along x and y; 1 where the period is square

  vec4 environment_mean[LODEN_ENVIRONMENT_THETAS];  // EnvironmentMean::rows
  LodenBandData bands[LODEN_MAX_BANDS];
};

#ifdef __cplusplus
static_assert(sizeof(LodenBandData) == 16 * (5 + LODEN_MAX_QUADS) + 2 * 4 * LODEN_MAX_QUADS);
static_assert(sizeof(LodenMaterialData) ==
              16 * (9 + LODEN_ENVIRONMENT_THETAS) + LODEN_MAX_BANDS * sizeof(LodenBandData));
}  // namespace loden
#endif

#endif
