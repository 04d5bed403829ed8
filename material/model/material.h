// A material in memory: what an asset holds, decoded into the terms of the one equation
//   value(x, lambda, wi, wo) = mu(wi, wo) + sum_b w_b(lambda) dot(D_b(q_b), E_b(wi, wo))
// with q_b = x in the reference domain and VDIM(x, wo) in the flat domain.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "material/model/band.h"
#include "material/model/directions.h"
#include "material/model/geometry_image.h"
#include "material/model/mu.h"
#include "material/model/texture.h"
#include "material/model/vdim.h"

namespace loden {

enum class Mode : uint32_t {
  kSurface = 0,  // FBTF's GPU mode: one analytic appearance read at VDIM(x, wo)
  kLod = 1,      // LBTF: bands in the reference domain
  kFused = 2,    // fine bands in the flat domain, coarse bands in the reference domain
};
const char* modeName(Mode mode);

// The analytic appearance over p: value = (diffuse + specular * (N.H)^exponent) * max(N.L, 0), N from the
// map.
struct SurfaceMaps {
  Texture normal;   // RGBA8 snorm, mips: xyz of the shading normal in the reference frame, whose length
                    // shrinks in the mips where normals differ; a unused. z < 0 on the underside of overhangs
  Texture diffuse;  // RGBA16 unorm, mips: linear albedo; a unused
  Texture specular;  // RG8 unorm, mips: r = strength / specular_scale, g = log2(exponent) / 12
  float specular_scale = 1;
  float lambda_first = 0;  // lambda of mip 0; above 0 of a tail alone
  int tail_mip = 0;        // mips from here on are stored apart from the finer ones
                           // (material/model/leading_part.h); 0: stored in one
};

struct Material {
  Mode mode = Mode::kFused;
  std::string name;
  int side = 0;          // reference texels per side at lambda 0
  float lambda_min = 0;  // the finest level that the bands give; above 0 if finer ones are left out
  float lambda_max = 0;  // the last level that any band gives
  float value_scale =
      1;  // radiance per unit perpendicular irradiance = value_scale * value; 1/pi for white = 1
  bool cosine_included = true;
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

}  // namespace loden
