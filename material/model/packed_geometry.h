// The geometry image packed into four bytes per texel, or two for a height field, for the VDIM look-ups: one
// gather fetches a whole patch.
#pragma once

#include "material/model/geometry_image.h"

namespace loden {

// A packed geometry image: at most half the bytes of the geometry image, and one gather per patch. Positions
// are within range.xy / 2044 and range.z / 4094 of the image's; for identity parameterizations z is as exact
// as in the image.
struct PackedGeometry {
  // side x side x 1; the four bytes (RGBA8) are one little-endian code, which the GPU binds as R32UI:
  //   bits 0..9, 10..19  P.xy - p = (code - 511) / 1022 * range.xy, up to a whole number of periods
  //   bits 20..30        P.z = (code / 2047 - 1) * range.z
  //   bit 31             the patch to the upper right of this texel exists
  // For identity parameterizations two bytes (RG8), which the GPU binds as R16 and filters:
  //   bits 0..15         P.z = (code / 65535 - 1) * range.z; every patch exists.
  Texture texels;
  glm::vec3 range{1, 1, 1};  // tile periods; range.xy at most 1, range.z > 0
  bool identity_parameterization = false;
  float aspect = 1;  // Material::aspect

  int side() const { return texels.width; }
};

PackedGeometry packGeometry(const GeometryImage& image);
// PackedGeometry::range of the packed image, without packing it.
glm::vec3 packedRange(const GeometryImage& image);

// Patch (i, j) of the packed image, like fetchPatch of the geometry image, except that the whole patch may be
// shifted by whole periods, and chart is 1 if the patch exists and 0 if not.
template <class T>
Patch<T> fetchPatch(const PackedGeometry& geometry, int i, int j);

}  // namespace loden
