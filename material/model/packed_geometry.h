// The geometry image in four bytes a texel, or two of a height field, as the lookups read it: one gather
// fetches a whole patch.
#pragma once

#include "material/model/geometry_image.h"

namespace loden {

// Half the bytes of the geometry image or less, and one gather for a patch. Positions are within
// range.xy / 2044 and range.z / 4094 of the image's; on identity parameterizations z is the image's own.
struct PackedGeometry {
  // side x side x 1; the four bytes (RGBA8) are one little-endian code, which the GPU binds as R32UI.
  //   bits 0..9, 10..19  P.xy - p = (code - 511) / 1022 * range.xy, but for a whole number of periods
  //   bits 20..30        P.z = (code / 2047 - 1) * range.z
  //   bit 31             the patch to the upper right of this texel exists
  // On identity parameterizations two bytes (RG8), which the GPU binds as R16 and filters:
  //   bits 0..15         P.z = (code / 65535 - 1) * range.z; every patch exists
  Texture texels;
  glm::vec3 range{1, 1, 1};  // tile periods; range.xy at most 1, range.z > 0
  bool identity_parameterization = false;
  float aspect = 1;  // Material::aspect

  int side() const { return texels.width; }
};

PackedGeometry packGeometry(const GeometryImage& image);
// Its range, without packing.
glm::vec3 packedRange(const GeometryImage& image);

// As fetchPatch of the geometry image, but the whole patch may be periods off; the chart is 1 where it
// exists, else 0.
template <class T>
Patch<T> fetchPatch(const PackedGeometry& geometry, int i, int j);

}  // namespace loden
