// The mips of a picture, as they are uploaded.
#pragma once

#include "material/model/texture.h"
#include "runtime/scene/scene.h"

namespace loden::runtime {

// The picture and its mips down to 1 x 1, as one layer of kRGBA8Unorm. A texel of a mip is the mean of the
// area that it covers in the mip before, rounded to the nearest code. `srgb`: the mean of red, green and blue
// is that of the linear values that the codes stand for, and is stored as an sRGB code.
Texture imageMips(const SceneImage& image, bool srgb);

}  // namespace loden::runtime
