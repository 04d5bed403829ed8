// The streamable parts of one material, and how a part is read from its asset. Private to the runtime; no GL.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "material/asset.h"
#include "material/evaluate.h"
#include "material/vdim.h"
#include "runtime/device.h"
#include "runtime/residency.h"
#include "runtime/shader_variants.h"

namespace loden::runtime {

enum class PartKind : uint8_t { kBand, kGeometry, kAtlas, kStoredVdim, kSurface };

struct PartPlan {
  PartKind kind = PartKind::kBand;
  int band = 0;         // of kBand: index in Material::bands
  VdimAtlasSize atlas;  // of kGeometry, which brings a small one, and of kAtlas, which replaces that
  PartDesc desc;
};

// Above this lambda the first atlas is less than .3 texels of what is shown off, about what the full one is at lambda 0.
inline constexpr float kFirstAtlasLambda = 1;

// Coarsest first, and what a part reads through before it: reference bands, then geometry, then flat bands.
// Surface maps come before their geometry. Last the full atlas, if it is larger than the first. Only what the variant
// reads.
std::vector<PartPlan> planParts(const Material& skeleton, const MaterialVariant& variant, VdimAtlasSize full_atlas);

// kLimit if a texture of one of the parts is larger than the driver takes.
Status checkExtents(const Material& skeleton, std::span<const PartPlan> parts, const Capabilities& gl);

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
  // Of a geometry part that a full atlas may follow: kept until that is built, since reading it again would cost more
  // than 130 KB of memory do for the while.
  std::shared_ptr<const GeometryImage> geometry;
};

// Reads, checks and decompresses; builds VDIM atlases, of an atlas part from `geometry`, or, if it is null, from the
// file. For the loading threads.
Result<LoadedPart> loadPart(const AssetFile& file, const PartPlan& plan, const GeometryImage* geometry, int threads);

}  // namespace loden::runtime
