// The level-of-detail BTF in the packed form of Ma et al. 2005, section 3.3 and figure 5: two RGBA textures
// of 32-bit floats.
#pragma once

#include "importer/base/picture.h"
#include "material/model/material.h"

namespace loden::importer {

struct PackedLod {
  // The eigen BRDFs: 3 p x (lambda_max + 1) q texels for p lights and q views: pixel (quad * p + light, level
  // * q + view). Quad 0 holds Y1..4, quad 1 Y5..8, quad 2 (Cb1, Cb2, Cr1, Cr2). 48 p q (lambda_max + 1)
  // bytes.
  Picture eigen;
  // The weights: 2 r x 2 r texels for r texels per side at level 0. The square of level k has twice the side
  // of its maps and holds quad 0 top left, quad 1 top right, and quad 2 bottom left; the square of level k +
  // 1 fills its fourth quarter. 64 r^2 bytes.
  Picture weights;
};

// The packed textures of a material. Row 0 of both is at the top, and holds view 0 and v = 0. Issues: kOption
// if the material is not of the published form, which is mode lod, tables at the sampled pairs, eight
// components of Y and two each of Cb and Cr, and sides that halve.
Result<PackedLod> packLod(const Material& material);

}  // namespace loden::importer
