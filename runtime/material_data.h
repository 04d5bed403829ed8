// The material's uniform block from its description: conversion only, no GL.
#pragma once

#include "material/material.h"
#include "material/result.h"
#include "runtime/shader_variants.h"
#include "shaders/loden_shared.h"

namespace loden::runtime {

// What the shader must be built for. kPaper where only a stored VDIM exists, kNone where nothing is read at p.
// kLimit if the material has more bands or quads than the shaders take, or mixes table layouts.
Result<MaterialVariant> materialVariant(const Material& material, Lookup lookup);

// The whole block, with everything resident (mean_chroma.zw = material's lambda_min, 1). Texel data is not
// looked at.
LodenMaterialData makeMaterialData(const Material& material, VdimAtlasSize atlas);

// Which parts are on the GPU, as far as the shader must know.
struct ResidentState {
  float lambda = 0;      // published: detail below is not shown; may exceed lambda_max, up to lambda_max + 1
  bool geometry = true;  // geometry image and VDIM
  uint32_t bands = ~0u;  // bit per band
};
// Clamps, closes the windows of absent bands, and fades those in that no window would.
void applyResidency(LodenMaterialData& data, const Material& material, const ResidentState& state);

}  // namespace loden::runtime
