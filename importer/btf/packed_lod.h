// The level-of-detail BTF as Ma et al. 2005, section 3.3 and figure 5, packs it: two RGBA textures of 32-bit
// floats.
#pragma once

#include "importer/base/picture.h"
#include "material/model/material.h"

namespace loden::importer {

struct PackedLod {
  // 3 p x (lambda_max + 1) q texels, p lights, q views: pixel (quad * p + light, level * q + view). Quad 0
  // holds Y1..4, quad 1 Y5..8, quad 2 (Cb1, Cb2, Cr1, Cr2). 48 p q (lambda_max + 1) bytes.
  Picture eigen;
  // 2 r x 2 r texels, r texels per side at level 0. The square of level k has twice the side of its maps and
  // holds quad 0 top left, quad 1 top right, quad 2 bottom left; the square of level k + 1 fills its fourth
  // quarter. 64 r^2 bytes.
  Picture weights;
};

// Row 0 of both is at the top, and holds view 0 and v = 0. Fails with kOption where the material is not of
// the published form: mode lod, tables at the sampled pairs, eight components of Y and two of Cb and of Cr,
// sides that halve.
Result<PackedLod> packLod(const Material& material);

}  // namespace loden::importer
