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

enum class PartKind : uint8_t { kBandLead, kBand, kGeometry, kAtlas, kStoredVdim, kSurfaceTail, kSurface };

struct PartPlan {
  PartKind kind = PartKind::kBand;
  int band = 0;         // of kBandLead and kBand: index in Material::bands
  VdimAtlasSize atlas;  // of kGeometry, which brings a small one, and of kAtlas, which replaces that
  PartDesc desc;
  bool shadow = false;  // of kSurfaceTail and kSurface: with the shadow map
};

// Above this lambda the first atlas is less than .3 texels of what is shown off, about what the full one is
// at lambda 0.
inline constexpr float kFirstAtlasLambda = 1;

// Coarsest first, and what a part reads through before it: reference bands, then geometry, then flat bands.
// Surface maps of a material without bands come before their geometry, or their tail
// does; of one with bands behind it. A leading part (material/model/leading_part.h)
// stands before the whole, has textures of its own, and is shown again when the whole goes. Last the full
// atlas, if it is larger than the first. Only what the variant reads.
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
// What a part was made of, if a later part begins with the same: kept until that is asked for, since reading
// it again would cost more than the memory does for the while.
struct KeptTexels {
  GeometryImage geometry;  // of kGeometry, for kAtlas
  Band lead;               // of kBandLead, for kBand
  SurfaceMaps tail;        // of kSurfaceTail, for kSurface
};

struct LoadedPart {
  std::vector<PartTexture> textures;
  std::shared_ptr<const KeptTexels> kept;
};

// The kind of the part whose kept texels such a part begins with; its own kind if there is none.
PartKind beginsWith(PartKind kind);

// Reads, checks and decompresses; builds VDIM atlases. What is kept of the part that this one begins with is
// not read again; null: all is read. After a stop an atlas comes back before it is whole. For the loading
// threads.
Result<LoadedPart> loadPart(const AssetFile& file, const PartPlan& plan, const KeptTexels* kept, int threads,
                            const std::stop_token& stop = {});

}  // namespace loden::runtime
