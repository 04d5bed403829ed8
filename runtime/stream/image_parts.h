// The streamable parts of a texture that is made of one image. Private to the runtime; no GL.
#pragma once

#include <vector>

#include "runtime/stream/image_texture.h"
#include "runtime/stream/material_parts.h"

namespace loden::runtime {

// The parts of an image's texture, coarsest first: the tail, which is the mips of at most 64 x 64 texels, and
// then one part for each finer mip that the driver takes. Each part is a texture of its own with all mips
// from its first on, so that the part before it is shown again when it is evicted; together they take a third
// more than the finest alone. Without mipmaps each part is one mip. Lambda is the mip of the image that is
// read.
std::vector<PartPlan> planImageParts(const Texture& mips, bool mipmapped, int most_side);

// The texture of a part; it refers to the image's mips.
PartTexture imagePart(const ImageTexture& image, const PartPlan& plan);

}  // namespace loden::runtime
