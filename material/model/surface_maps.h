// The near term of the equation, V(P, wi) A(p; wi, wo) + C(p, wi), as texture maps over the tile's own
// surface, which are read at the parameter p.
#pragma once

#include <array>
#include <cstdint>

#include "material/model/texture.h"

namespace loden {

// The specular lobe of the surface, which is added to its diffuse part.
enum class Lobe : uint32_t {
  kPhong = 0,  // Blinn-Phong: strength (N.H)^exponent
  kGgx = 1,    // glTF 2.0, appendix B: metalness and roughness
};

// How V is found, which is whether light from wi reaches P or is blocked by the tile.
enum class Visibility : uint32_t {
  kNone = 0,  // not at all: V = 1, no cast shadows
  // By the VDIM look-up along wi with Lookup::kFast: the look-up that serves the eye serves the light.
  kFast = 1,
  kDefault = 2,  // by the VDIM look-up along wi with Lookup::kDefault
  kMap = 3,      // by the shadow map over p: softer, and the cheapest for each light after the first
};
// The name of a visibility: "none", "fast", "default" or "map".
const char* visibilityName(Visibility visibility);
// Whether V is found by a VDIM look-up along the light's direction.
constexpr bool byLookup(Visibility visibility) {
  return visibility == Visibility::kFast || visibility == Visibility::kDefault;
}

// The maps of the near term. All have mips, of which the last is one texel unless bands take over before.
//
// `normal` and `color` give the local reflectance A = diffuse * max(N.L, 0) + lobe * (N'.L). N is the mean
// normal as stored, shorter than 1 where normals vary, which makes N.L the mean where all normals are lit. N'
// is N at unit length. The lobe's width includes that of the surface and that of the normals within a texel
// (after Toksvig 2004).
struct SurfaceMaps {
  Lobe lobe = Lobe::kPhong;
  // RGBA8 snorm. xyz: mean normal in the reference frame, z < 0 on the underside of overhangs. a: width of
  // the lobe, for Phong log2(exponent) / 12, for GGX roughness (the square root of alpha).
  Texture normal;
  // RGBA8 unorm. Phong: rgb the square root of the diffuse albedo, a strength / specular_scale. GGX: rgb the
  // square root of the base colour, a metalness. Square roots keep fine steps in dark colours, and every
  // renderer decodes them alike (drivers' sRGB decoding differs by up to .0013 of white).
  Texture color;
  // RGBA8 snorm, two layers: how much environment light reaches the surface, T_k = 1 / pi * integral over the
  // hemisphere of V max(N.w, 0) h_k(w) dw for the basis h_k of material/model/environment.h; k = 0..3 in
  // layer 0, k = 4 and 5 in layer 1, whose other channels are unused.
  Texture ambient;
  // The shadow map and its table; both or neither exist. The share of the light from wi that the rest of the
  // tile keeps away from p is clamp(sum over layers of dot(shadow(p), shadow_table(wi)), 0, 1). shadow is
  // RGBA8 snorm, four components per layer. shadow_table is RGBA16 float, square, read at
  // squareFromDirection(wi) (material/model/directions.h), with the centres of its outer texels at the
  // square's edges.
  Texture shadow, shadow_table;
  // The indirect map, RGBA8 snorm, two layers, or absent. C = reflects(p) e(p, wi) is the light from wi that
  // other parts of the tile send to p, where it is treated as diffuse. e = t rgb^2 with rgb of layer 0 and t
  // = max(0, wi.z (r + g wi.z + b wi.x + a wi.y)) of layer 1, which is the light that enters the tile times a
  // linear polynomial of the direction. reflects is the share of diffuse light that the surface returns
  // (nearAlbedo of material/eval/near_term.h).
  Texture indirect;
  float specular_scale = 1;  // for Lobe::kPhong: the strength that 1 in `color` stands for
  // Lambda of mip 0 of normal and color; below 0 if they are finer than Material::side.
  float lambda_first = 0;
  float ambient_first = 0;  // lambda of mip 0 of ambient, shadow and indirect
  // The mip from which on all maps are stored apart from the finer mips (material/model/leading_part.h); 0:
  // stored in one piece.
  int tail_mip = 0;
  // The weight w(lambda) of the near term: 1 up to fade_begin, 0 from fade_end on, linear in between. It is 1
  // at every lambda in materials without bands.
  float fade_begin = 1e4f, fade_end = 2e4f;
  Visibility visibility = Visibility::kNone;
};

// The description of one map of SurfaceMaps. Code that writes, reads, checks, loads, lists or counts maps
// iterates over kSurfaceMapRows.
struct SurfaceMapRow {
  const char* name;
  Texture SurfaceMaps::*texture;
  TexelFormat format;
  int layers;  // 0: any number
  // The member with lambda of mip 0; null for a table over the light's direction, which has one mip and is
  // clamped.
  float SurfaceMaps::*first;
  bool optional = false;  // the map may be absent
};

// All maps, in file order.
inline constexpr std::array kSurfaceMapRows = {
    SurfaceMapRow{"normal", &SurfaceMaps::normal, TexelFormat::kRGBA8Snorm, 1, &SurfaceMaps::lambda_first},
    SurfaceMapRow{"color", &SurfaceMaps::color, TexelFormat::kRGBA8Unorm, 1, &SurfaceMaps::lambda_first},
    SurfaceMapRow{"ambient", &SurfaceMaps::ambient, TexelFormat::kRGBA8Snorm, 2, &SurfaceMaps::ambient_first},
    SurfaceMapRow{"shadow", &SurfaceMaps::shadow, TexelFormat::kRGBA8Snorm, 0, &SurfaceMaps::ambient_first,
                  true},
    SurfaceMapRow{"shadow_table", &SurfaceMaps::shadow_table, TexelFormat::kRGBA16Sfloat, 0, nullptr, true},
    SurfaceMapRow{"indirect", &SurfaceMaps::indirect, TexelFormat::kRGBA8Snorm, 2,
                  &SurfaceMaps::ambient_first, true},
};

// The maps without the shadow map and its table.
SurfaceMaps withoutShadow(SurfaceMaps maps);

}  // namespace loden
