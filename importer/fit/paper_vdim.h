// Packs the displacements of a baked output into the published indirection map.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "material/model/vdim.h"

namespace loden::importer {

// The packed map. `vdim` is [zenith][azimuth][texel] p - x, as BakedOutput::vdim returns it; 16 bits per
// channel.
PaperVdim packPaperVdim(const std::vector<glm::vec2>& vdim, int side, int zeniths, int azimuths);

}  // namespace loden::importer
