// A material in memory, which is what an asset holds. Its fields are the terms of one equation
//   value(x, lambda, wi, wo) = w(lambda) [V(P, wi) A(p; wi, wo) + C(p, wi)]
//                            + (1 - w(lambda)) [mu(wi, wo) + sum_b w_b(lambda) dot(D_b(q_b), E_b(wi, wo))]
// where x is a point of the reference plane, lambda the level of detail, wi and wo the directions to light
// and eye; p, P = VDIM(x, wo) are the parameter and the position at which the view ray through x meets the
// tile; and q_b = x for a band in the reference domain, p in the flat domain. The near term (A, V and C) is
// computed from the surface: A is the local reflectance, V whether the light reaches P, and C the light that
// arrives by way of other parts of the tile. The mean mu and the bands are fitted. Flat-BTF's GPU mode (FBTF:
// Hadim et al. 2009, 3.5) is the near term alone with V = 1 and C = 0; LOD-BTF (LBTF: Ma et al. 2005) is the
// rest alone.
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
  kSurface = 0,  // FBTF's GPU mode: the near term alone, read at VDIM(x, wo)
  kLod = 1,      // LBTF: bands in the reference domain
  // The near term, or fine bands in the flat domain, with coarse bands in the reference domain.
  kFused = 2,
};
const char* modeName(Mode mode);

struct Material {
  Mode mode = Mode::kFused;
  std::string name;
  int side = 0;          // reference texels per side of a period; lambda is 0 where one covers one pixel
  float lambda_min = 0;  // finest level that the bands give; above 0 if finer bands are left out
  float lambda_max = 0;  // coarsest level that any band gives
  // Radiance per unit of irradiance on a perpendicular surface = value_scale * value; 1/pi where white = 1.
  float value_scale = 1;
  // Whether values include the cosine of the light's angle.
  bool cosine_included = true;
  float aspect = 1;  // the tile's period in y over that in x; 1 for a square tile
  float period = 0;  // the tile's period in x, metres; 0: unknown
  // The largest theta of the tables, radians. Beyond it they repeat their last row, and fade with cos(theta)
  // / cos(theta_max) if the cosine is included.
  float theta_max = static_cast<float>(75.0 * kPi / 180.0);
  PhongMean mean;
  DirectionSet lights, views;  // sampled directions of tables of TableLayout::kNearest; empty otherwise
  std::vector<Band> bands;     // finest first; the file stores them coarsest first
  GeometryImage geometry;      // empty if the material has no meso-geometry
  // The atlas of the VDIM look-up through which flat bands were fitted; unused without geometry.
  VdimAtlasSize atlas;
  std::optional<PaperVdim>
      stored_vdim;  // for baked folders from elsewhere without geometry, and for FBTF as published
  std::optional<SurfaceMaps> surface;
  // Free text for readers: how the material was cooked and what error was measured.
  std::string meta_json;
};

// The finest level that the material gives: lambda_min if that is above 0, else 0 or the level of near maps
// that are finer than the reference texels.
float finestLevel(const Material& material);

// The weight w(lambda) of the near term: 0 at every lambda without surface maps, 1 at every lambda without
// bands.
template <class T>
T nearWeight(const Material& material, T lambda);

}  // namespace loden
