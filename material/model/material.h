// A material in memory: what an asset holds, decoded into the terms of the one equation
//   value(x, lambda, wi, wo) = w(lambda) [V(P, wi) A(p; wi, wo) + C(p, wi)]
//                            + (1 - w(lambda)) [mu(wi, wo) + sum_b w_b(lambda) dot(D_b(q_b), E_b(wi, wo))]
// with p, P = VDIM(x, wo) and q_b = x in the reference domain, p in the flat domain. A, V and C, the near
// term, is what is known of the surface: its local reflectance, whether the light meets it, and what light
// comes by way of the tile. mu and the bands are what is fitted. Flat-BTF's GPU mode (Hadim et al. 2009, 3.5)
// is the near term alone with V = 1 and C = 0, LOD-BTF (Ma et al. 2005) the rest alone.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "material/model/band.h"
#include "material/model/directions.h"
#include "material/model/geometry_image.h"
#include "material/model/mu.h"
#include "material/model/surface_maps.h"
#include "material/model/texture.h"
#include "material/model/vdim.h"

namespace loden {

enum class Mode : uint32_t {
  kSurface = 0,  // FBTF's GPU mode: one analytic appearance read at VDIM(x, wo)
  kLod = 1,      // LBTF: bands in the reference domain
  kFused = 2,    // the near term, or fine bands in the flat domain; coarse bands in the reference domain
};
const char* modeName(Mode mode);

struct Material {
  Mode mode = Mode::kFused;
  std::string name;
  int side = 0;          // reference texels per side at lambda 0
  float lambda_min = 0;  // the finest level that the bands give; above 0 if finer ones are left out
  float lambda_max = 0;  // the last level that any band gives
  float value_scale =
      1;  // radiance per unit perpendicular irradiance = value_scale * value; 1/pi for white = 1
  bool cosine_included = true;
  float aspect = 1;  // of the tile: its period in y to that in x; 1 of a square one
  float period = 0;  // of the tile in x, metres; 0: nobody has said
  // Beyond this theta tables repeat their last row, and fade with cos(theta) / cos(theta_max) if the cosine
  // is included; radians.
  float theta_max = static_cast<float>(75.0 * kPi / 180.0);
  PhongMean mean;
  DirectionSet lights, views;  // of nearest-layout tables; empty otherwise
  std::vector<Band> bands;     // finest first; the file stores them coarsest first
  GeometryImage geometry;      // empty if the material has no meso-geometry
  VdimAtlasSize atlas;  // of the lookup on it that flat bands were fitted through; without geometry unused
  std::optional<PaperVdim>
      stored_vdim;  // for folders baked elsewhere without geometry, and FBTF as published
  std::optional<SurfaceMaps> surface;
  std::string meta_json;  // how it was cooked and what error was measured; free text for the reader
};

// The finest level that the material gives: lambda_min if that is above 0, else 0 or that of finer near maps.
float finestLevel(const Material& material);

// w(lambda) of the near term; 0 without surface maps, 1 at every lambda without bands.
template <class T>
T nearWeight(const Material& material, T lambda);

}  // namespace loden
