// The near term of the equation, V(P, wi) A(p; wi, wo) + C(p, wi), as maps over the tile's own surface.
#pragma once

#include <array>
#include <cstdint>

#include "material/model/texture.h"

namespace loden {

// How the surface scatters what its diffuse part does not.
enum class Lobe : uint32_t {
  kPhong = 0,  // Blinn-Phong: strength (N.H)^exponent
  kGgx = 1,    // glTF 2.0, appendix B: metalness and roughness
};

// How V is found: whether the light from wi meets P first.
enum class Visibility : uint32_t {
  kNone = 0,     // it is not: V = 1, no cast shadows
  kFast = 1,     // by the VDIM lookup along wi, Lookup::kFast: what answers the eye answers the light
  kDefault = 2,  // by Lookup::kDefault
  kMap = 3,      // by the shadow map over p: softer, and least for each light after the first
};
// "none", "fast", "default", "map".
const char* visibilityName(Visibility visibility);
constexpr bool byLookup(Visibility visibility) {
  return visibility == Visibility::kFast || visibility == Visibility::kDefault;
}

// All maps have mips, of which the last is one texel unless bands take over before. normal and color are the
// local reflectance A = (diffuse max(N.L, 0) + lobe (N'.L)), with the mean normal N as it is stored for the
// diffuse part (the mean of N.L where all is lit), and of unit length (N') for the lobe, whose width is that
// of the surface and of the normals that a texel holds (after Toksvig 2004).
struct SurfaceMaps {
  Lobe lobe = Lobe::kPhong;
  // RGBA8 snorm: xyz the mean normal in the reference frame, z < 0 on the underside of overhangs; a the
  // lobe's width: Phong log2(exponent) / 12, GGX roughness (the square root of alpha).
  Texture normal;
  // RGBA8 unorm: Phong rgb the square root of the diffuse albedo, a strength / specular_scale; GGX rgb the
  // square root of the base colour, a metalness. Roots keep the steps of darks, and every renderer reads them
  // alike (drivers decode sRGB each in its own way, up to .0013 of white apart).
  Texture color;
  // RGBA8 snorm, two layers: what of light from all around meets the surface, T_k = 1 / pi * integral over
  // the hemisphere of V max(N.w, 0) h_k(w) dw for the basis h_k of material/model/environment.h; k = 0..3 in
  // layer 0, 4 and 5 in layer 1, the rest unused.
  Texture ambient;
  // Both or neither: the share of the light from wi that the rest of the tile keeps away from p is
  // clamp(sum over layers of dot(shadow(p), shadow_table(wi)), 0, 1). shadow is RGBA8 snorm, four components
  // a layer; shadow_table RGBA16 float, square, read at squareFromDirection(wi)
  // (material/model/directions.h), its outer texels' centres at the square's edges.
  Texture shadow, shadow_table;
  // RGBA8 snorm, two layers, or absent: C = reflects(p) e(p, wi), the light from wi that other parts of the
  // tile send to p, diffuse there. e = t rgb^2 of layer 0, t = max(0, wi.z (r + g wi.z + b wi.x + a wi.y)) of
  // layer 1: as much as enters the tile, and a linear polynomial of the direction. reflects is all that the
  // surface returns of diffuse light (material/eval/near_term.h).
  Texture indirect;
  float specular_scale = 1;  // of Phong
  float lambda_first = 0;    // lambda of mip 0 of normal and color; below 0 where they are finer than `side`
  float ambient_first = 0;   // of mip 0 of ambient, shadow and indirect
  int tail_mip = 0;          // mips of all maps from here on are stored apart from the finer ones
                             // (material/model/leading_part.h); 0: stored in one
  // w(lambda): 1 up to fade_begin, 0 from fade_end on, linear between. 1 everywhere in materials without
  // bands.
  float fade_begin = 1e4f, fade_end = 2e4f;
  Visibility visibility = Visibility::kNone;
};

// One map of SurfaceMaps. What writes, reads, checks, loads, lists or counts them walks kSurfaceMapRows.
struct SurfaceMapRow {
  const char* name;
  Texture SurfaceMaps::*texture;
  TexelFormat format;
  int layers;  // 0: any number
  float SurfaceMaps::*
      first;              // lambda of mip 0; null: a table over the light's direction, of one mip, clamped
  bool optional = false;  // the map may be absent
};

// In file order.
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

// Without the shadow map and its table.
SurfaceMaps withoutShadow(SurfaceMaps maps);

}  // namespace loden
