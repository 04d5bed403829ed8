// The streamable parts of one material, and how a part is read from its asset. Private to the runtime; no GL.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "material/asset.h"
#include "material/evaluate.h"
#include "material/vdim.h"
#include "runtime/device.h"
#include "runtime/residency.h"
#include "runtime/shader_variants.h"

namespace loden::runtime {

enum class PartKind : uint8_t { kBand, kGeometry, kStoredVdim, kSurface };

struct PartPlan {
  PartKind kind = PartKind::kBand;
  int band = 0;  // of kBand: index in Material::bands
  PartDesc desc;
};

// Coarsest first, and what a part reads through before it: reference bands, then geometry, then flat bands.
// Surface maps come before their geometry. Only what the variant reads.
std::vector<PartPlan> planParts(const Material& skeleton, const MaterialVariant& variant, VdimAtlasSize atlas);

// kLimit if a texture of one of the parts is larger than the driver takes.
Status checkExtents(const Material& skeleton, std::span<const PartPlan> parts, VdimAtlasSize atlas,
                    const Capabilities& gl);

// The largest atlas, up to `wanted`, that takes at most a sixteenth of the budget; never below 16 x 16 texels.
VdimAtlasSize fitAtlas(VdimAtlasSize wanted, uint64_t budget_bytes);

// How a texture is sampled when its unit is bound.
enum class Sampling : uint8_t { kRepeatTrilinear, kRepeatLinear, kRepeatNearest, kClampLinear, kClampNearest };

struct PartTexture {
  int unit = 0;  // of shaders/loden_shared.h
  Sampling sampling = Sampling::kRepeatTrilinear;
  bool plain_2d = false;  // a geometry image: GL_TEXTURE_2D of R32UI (shaders/loden_vdim.glsl) rather than an array
  const char* label = "";
  Texture texels;
};
struct LoadedPart {
  std::vector<PartTexture> textures;
};
// Reads, checks and decompresses; builds the VDIM atlas of a geometry part. For the loading thread.
Result<LoadedPart> loadPart(const AssetFile& file, const PartPlan& plan, VdimAtlasSize atlas, int threads);

}  // namespace loden::runtime
