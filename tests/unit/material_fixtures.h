// Small materials of each mode with seeded texels, for tests of the container and the evaluator.
#pragma once

#include <vector>

#include "material/model/material.h"

namespace loden::test {

// Pseudo-random texels of a finite value in every format.
Texture noiseTexture(TexelFormat format, TextureShape shape, int width, int height, int depth, int mips,
                     uint32_t seed);

Material surfaceMaterial();  // geometry image, stored VDIM, three maps, no band
Material lodMaterial();      // three nearest-layout bands, RGBA32F, one spare layer
Material fusedMaterial();    // flat band with ratio, reference band with mips, geometry image, 8 bit
Material nearMaterial();     // near term of GGX maps, twice as fine as the side, shadow map, reference band

// fusedMaterial, with its reference band (of three quads, a ratio and a spare layer) stored in two chunks.
Material splitFusedMaterial();
// surfaceMaterial, with its maps and a shadow map stored in two chunks.
Material splitSurfaceMaterial();

// Expects that every field and texel of the two is the same.
void expectSame(const Material& a, const Material& b);

}  // namespace loden::test
