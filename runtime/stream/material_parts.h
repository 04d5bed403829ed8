// The streamable parts of one material, and how a part is read from its asset. Private to the runtime; no GL.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>
#include <vector>

#include "material/asset/asset.h"
#include "material/eval/evaluate.h"
#include "material/model/maps.h"
#include "material/model/vdim.h"
#include "runtime/gl/device.h"
#include "runtime/stream/residency.h"
#include "runtime/stream/shader_variants.h"

namespace loden::runtime {

// One entry of a material's list of parts. Something that is stored in two pieces has two entries of the same
// kind and band: first its leading part, later the whole. For bands and surface maps the leading part is that
// of material/model/leading_part.h; for the geometry it is the image with a small atlas, and the second entry
// is the depths of the full atlas.
struct PartPlan {
  PartKind kind = PartKind::kBand;
  int band = 0;         // kBand only: index in Material::bands
  VdimAtlasSize atlas;  // kGeometry only: the atlas to build
  PartDesc desc;
  Share share = Share::kWhole;
  bool shadow = false;  // kSurface only: load the shadow map too
  // Of an image's texture (image_parts.h), which has no kind: the part's first mip, and the number of its
  // mips.
  int first_mip = 0, mips = 0;
};

// Above this lambda the first (small) atlas is good enough: its error is below .3 texels of the level that is
// shown, about the error of the full atlas at lambda 0.
inline constexpr float kFirstAtlasLambda = 1;

// The parts of a material in the order in which they are loaded, coarsest first. Only what the variant reads
// is listed. A part that others are read through comes before them: reference bands first, then geometry,
// then flat bands. Surface maps of a material without bands, or their leading part, come before the geometry;
// those of a material with bands come after it. A leading part comes before the whole, has textures of its
// own, and is shown again when the whole is evicted. The full atlas comes last, if it is larger than the
// first one.
std::vector<PartPlan> planParts(const Material& skeleton, const MaterialVariant& variant,
                                VdimAtlasSize full_atlas);

// Checks the sizes of the parts' textures. Issues: kLimit if one is larger than the driver takes.
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
  int unit = 0;  // texture unit (LODEN_UNIT_* of shaders/loden_shared.h)
  Sampling sampling = Sampling::kRepeatTrilinear;
  // True for a GL_TEXTURE_2D: an image's mips, or a geometry image, which is R32UI or R16
  // (shaders/loden_interface.glsl); false: an array.
  bool plain_2d = false;
  const char* label = "";
  Texture texels;
  // If set, the texels are, in place of `texels`, these mips of an image that is kept elsewhere.
  std::shared_ptr<const Texture> image = nullptr;
  int first_mip = 0, mips = 0;
  bool srgb = false;  // of `image`: red, green and blue are sRGB codes

  const Texture& source() const { return image ? *image : texels; }
  int endMip() const { return image ? first_mip + mips : texels.mips; }
};

struct LoadedPart {
  std::vector<PartTexture> textures;
  // The material that a leading part was made of. It is kept in memory until the whole is requested, so that
  // it need not be read again.
  std::shared_ptr<const Material> lead;
};

// The textures of one part, which is read, checked and decompressed; a part of the geometry also gets its
// VDIM atlas built. `lead`: what LoadedPart::lead of the leading part held, so that only the rest is read;
// null: everything is read. After a stop request an atlas is returned unfinished. Called on the loading
// threads.
Result<LoadedPart> loadPart(const AssetFile& file, const PartPlan& plan, const Material* lead, int threads,
                            const std::stop_token& stop = {});

}  // namespace loden::runtime
