// The three modes of cook(), one function each (design: the one equation and its special cases).
#pragma once

#include <functional>

#include "importer/base/progress.h"
#include "importer/cook/cook.h"
#include "importer/cook/near_term.h"
#include "importer/fit/ycc_btf.h"

namespace loden::importer {

// The geometry image of a baked output, reduced to `side` by 2 x 2 means (0: as baked).
Result<GeometryImage> geometryOf(const BakedOutput& input, int side);

// Refuses more levels than a side has; 0 stands for the preset's.
Status checkLevels(int levels, int side);

// LBTF: bands in the reference domain. Preset seed as published, the others improved.
Result<Material> cookLod(const BtfSource& source, const CookOptions& options);
// The same from data that is in memory already, without measuring. The progress advances by kLodSteps in all.
inline constexpr uint64_t kLodSteps = 8;
Result<Material> fitLod(const BtfSource& source, const YccBtf& btf, const CookOptions& options,
                        Progress* progress = nullptr);

// The near term, or fine bands in the flat domain; coarse bands in the reference domain.
// A goal in `options` chooses the plan by measuring candidates.
using GeometryReader = std::function<Result<GeometryImage>(int side)>;  // geometryOf of the input
Result<Material> cookFused(const BtfSource& source, const GeometryReader& geometry,
                           const BakedSurface& surface, const CookOptions& options);

// FBTF's GPU mode: one analytic appearance read at VDIM(x, wo).
Result<Material> cookSurface(const BakedOutput& input, const CookOptions& options);

}  // namespace loden::importer
