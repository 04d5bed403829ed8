// The three modes of cook(), one function each; each is a special case of the equation in
// material/model/material.h.
#pragma once

#include <functional>

#include "importer/base/progress.h"
#include "importer/cook/cook.h"
#include "importer/cook/near_term.h"
#include "importer/fit/ycc_btf.h"

namespace loden::importer {

// The geometry image of a baked output, reduced to `side` by 2 x 2 means (0: as baked).
Result<GeometryImage> geometryOf(const BakedOutput& input, int side);

// Checks that a side has so many levels; 0 stands for the preset's.
Status checkLevels(int levels, int side);

// Cooks mode lod (LBTF): bands in the reference domain. Preset kSeed is as published, the others are
// improved.
Result<Material> cookLod(const BtfSource& source, const CookOptions& options);
// Fits mode lod to data in memory, without measuring the error. `progress` advances by kLodSteps in all.
inline constexpr uint64_t kLodSteps = 8;
Result<Material> fitLod(const BtfSource& source, const YccBtf& btf, const CookOptions& options,
                        Progress* progress = nullptr);

// Cooks mode fused: the near term, or fine bands in the flat domain, and coarse bands in the reference
// domain. A goal in `options` chooses the plan by measuring candidates.
using GeometryReader = std::function<Result<GeometryImage>(int side)>;  // calls geometryOf for the input
Result<Material> cookFused(const BtfSource& source, const GeometryReader& geometry,
                           const BakedSurface& surface, const CookOptions& options);

// Cooks mode surface (FBTF's GPU mode): the near term alone, read at VDIM(x, wo).
Result<Material> cookSurface(const BakedOutput& input, const CookOptions& options);

}  // namespace loden::importer
