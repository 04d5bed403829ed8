// The uniform block of a material's shader, computed from the material's description. Only conversion: no GL.
#pragma once

#include <array>

#include "material/base/result.h"
#include "material/model/material.h"
#include "runtime/stream/shader_variants.h"
#include "shaders/loden_shared.h"

namespace loden::runtime {

// The shader variant that a material needs. The lookup is kPaper where only a stored VDIM exists, and kNone
// where nothing is read at p. `visibility` is as in MaterialSystemOptions. Issues: kLimit if the material has
// more bands or quads than the shaders take, or mixes table layouts.
Result<MaterialVariant> materialVariant(const Material& material, Lookup lookup,
                                        Visibility visibility = Visibility::kDefault);

// The uniform block, except for what applyResidency writes. Texel data is not read.
LodenMaterialData makeMaterialData(const Material& material);

// Which parts of a material are on the GPU, as far as the shader must know.
struct ResidentState {
  // Finest level to show (Residency::publishedLambda); may exceed lambda_max by coarsestFade.
  float lambda = 0;
  VdimAtlasSize atlas{0, 0};  // the VDIM atlas to read; 0: geometry image and atlas are not there yet
  uint32_t bands = 0;         // bit per band of which at least the leading part is there
  uint32_t leads = 0;         // bit per band of which only the leading part is there
  // Per band that is there whole: the share, 0 to 1, at which quads after the leading part are shown.
  std::array<float, LODEN_MAX_BANDS> rest{};
  bool surface = false;  // surface maps are there, at least their coarse mips (the tail)
  bool tail = false;     // only the tail of the surface maps is read
  friend bool operator==(const ResidentState&, const ResidentState&) = default;
};
// The coarsest level of detail that bands or surface maps have.
float coarsestLevel(const Material& material);
// The number of levels beyond coarsestLevel over which the first part fades in. It is larger for surface maps
// than for a band, since they differ more from the fitted mean, which includes shadows.
float coarsestFade(const Material& material);
// How far the first part has faded in: from 0 at a published lambda of coarsestLevel + coarsestFade to 1 at
// coarsestLevel.
float coarsestShare(const Material& material, const ResidentState& state);
// The finest lambda to show, given the published one. Below a published lambda of 1 it continues to the level
// of near maps that are finer than the reference texels.
float shownLambda(const Material& material, float published);
// Writes to the uniform block what depends on the resident parts: which atlas is read, the lowest lambda,
// windows that close absent bands, and the shares of what fades in or is there in part only.
void applyResidency(LodenMaterialData& data, const Material& material, const ResidentState& state);

}  // namespace loden::runtime
