// The streamable parts of one material, and how a part is read from its asset. Private to the runtime; no GL.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>
#include <vector>

#include "material/asset/asset.h"
#include "material/eval/evaluate.h"
#include "material/model/vdim.h"
#include "runtime/gl/device.h"
#include "runtime/stream/residency.h"
#include "runtime/stream/shader_variants.h"

namespace loden::runtime {

enum class PartKind : uint8_t { kBand, kGeometry, kStoredVdim, kSurface };

// A leading part is followed by the whole, of the same kind and band: of bands and surface maps as
// material/model/leading_part.h has it; of the geometry the image with a small atlas, before the depths of
// the full one.
struct PartPlan {
  PartKind kind = PartKind::kBand;
  int band = 0;         // of kBand: index in Material::bands
  VdimAtlasSize atlas;  // of kGeometry
  PartDesc desc;
  Share share = Share::kWhole;
  bool shadow = false;  // of kSurface: with the shadow map
};

// Above this lambda the first atlas is less than .3 texels of what is shown off, about what the full one is
// at lambda 0.
inline constexpr float kFirstAtlasLambda = 1;

// Coarsest first, and what a part reads through before it: reference bands, then geometry, then flat bands.
// Surface maps of a material without bands come before their geometry, or their leading part does; of one
// with bands behind it. A leading part stands before the whole, has textures of its own, and is shown again
// when the whole goes. Last the full atlas, if it is larger than the first. Only what the variant reads.
std::vector<PartPlan> planParts(const Material& skeleton, const MaterialVariant& variant,
                                VdimAtlasSize full_atlas);

// kLimit if a texture of one of the parts is larger than the driver takes.
Status checkExtents(const Material& skeleton, std::span<const PartPlan> parts, const Capabilities& gl);

// How a texture is sampled when its unit is bound.
enum class Sampling : uint8_t {
  kRepeatTrilinear,
  kRepeatLinear,
  kRepeatNearest,
  kClampLinear,
  kClampNearest
};

struct PartTexture {
  int unit = 0;  // of shaders/loden_shared.h
  Sampling sampling = Sampling::kRepeatTrilinear;
  bool plain_2d =
      false;  // a geometry image: GL_TEXTURE_2D of R32UI or R16 (shaders/loden_interface.glsl) and no array
  const char* label = "";
  Texture texels;
};

struct LoadedPart {
  std::vector<PartTexture> textures;
  // What a leading part was made of, kept until the whole is asked for: reading it again would cost more than
  // the memory does for the while.
  std::shared_ptr<const Material> lead;
};

// Reads, checks and decompresses; builds VDIM atlases. Of a whole `lead` is not read again; null: all is
// read. After a stop an atlas comes back before it is whole. For the loading threads.
Result<LoadedPart> loadPart(const AssetFile& file, const PartPlan& plan, const Material* lead, int threads,
                            const std::stop_token& stop = {});

}  // namespace loden::runtime
