// The material's uniform block from its description: conversion only, no GL.
#pragma once

#include <array>

#include "material/base/result.h"
#include "material/model/material.h"
#include "runtime/stream/shader_variants.h"
#include "shaders/loden_shared.h"

namespace loden::runtime {

// What the shader must be built for. kPaper where only a stored VDIM exists, kNone where nothing is read at
// p. kLimit if the material has more bands or quads than the shaders take, or mixes table layouts.
// `visibility` as MaterialSystemOptions has it.
Result<MaterialVariant> materialVariant(const Material& material, Lookup lookup,
                                        Visibility visibility = Visibility::kDefault);

// The whole block but for what applyResidency writes. Texel data is not looked at.
LodenMaterialData makeMaterialData(const Material& material);

// Which parts are on the GPU, as far as the shader must know.
struct ResidentState {
  float lambda = 0;           // published: detail below is not shown; may exceed lambda_max by coarsestFade
  VdimAtlasSize atlas{0, 0};  // the one to read; 0: no geometry image and atlas yet
  uint32_t bands = 0;         // bit per band that is there, if only by its leading part
  uint32_t leads = 0;         // bit per band that is there by its leading part alone
  std::array<float, LODEN_MAX_BANDS> rest{};  // share of the other quads, of bands that are there whole
  bool surface = false;                       // surface maps are there, if only their tail
  bool tail = false;                          // of them the tail is read
  friend bool operator==(const ResidentState&, const ResidentState&) = default;
};
// The last level that bands or surface maps have.
float coarsestLevel(const Material& material);
// What is needed at every lambda fades in over these levels beyond coarsestLevel. Surface maps differ more
// from the fitted mean, which knows of shadows, than a band does.
float coarsestFade(const Material& material);
// How far it has faded in, from 0 at a published coarsestLevel + coarsestFade to 1 at coarsestLevel.
float coarsestShare(const Material& material, const ResidentState& state);
// The finest lambda to show at a published one: below 1 it goes on to the level of near maps that are finer
// than the reference texels.
float shownLambda(const Material& material, float published);
// Names the atlas, clamps lambda, closes the windows of absent bands, and fades those in that no window
// would; reads what is there of bands and maps that are there in part, and fades the rest in.
void applyResidency(LodenMaterialData& data, const Material& material, const ResidentState& state);

}  // namespace loden::runtime
