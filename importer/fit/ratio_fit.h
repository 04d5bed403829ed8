// Fits chroma as a ratio to luma per flat texel: Cb = a_p Y, which holds where a point's colour is one
// albedo.
#pragma once

#include <vector>

#include "importer/fit/indirection.h"
#include "importer/fit/pca.h"
#include "importer/fit/ycc_btf.h"
#include "material/model/mu.h"

namespace loden::importer {

// The ratios r, one per flat texel, that minimise the sum over views and lights of (Y_v + .02)^(-4/3) |(A_v
// r) Y_v - C_v|^2 for the Y that the asset gives, which approximates distances in Lab. `luma`, `chroma`:
// texels x (views * lights). `start` fills texels that no view sees.
std::vector<double> fitRatio(const ColumnBlocks& luma, const ColumnBlocks& chroma, const Indirection& a,
                             double start, int threads);

// The luma that an asset gives: `mean` + (A_v weights) basis^T, clamped at zero; `mean` is the result of
// sampleMean. All arguments must outlive it.
ColumnBlocks wholeLuma(const YccBtf& btf, const Factors& luma, const Matrix& mean, const Indirection& a);

// (Cb/Y, Cr/Y) per flat texel for the luma that the asset gives, fitted by fitRatio.
std::vector<glm::dvec2> fitRatios(const YccBtf& btf, const ColumnBlocks& luma, const PhongMean& phong,
                                  const Indirection& a, int threads);

// The residual of channel 1 (Cb) or 2 (Cr) after the ratios. All arguments must outlive it.
ColumnBlocks ratioResidual(const YccBtf& btf, int channel, const ColumnBlocks& luma,
                           const std::vector<glm::dvec2>& ratios, const Indirection& a);

}  // namespace loden::importer
