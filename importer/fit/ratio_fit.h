// Chroma as a ratio to luma per flat texel: Cb = a_p Y (holds where a point's colour is one albedo).
#pragma once

#include <vector>

#include "importer/fit/indirection.h"
#include "importer/fit/ycc_btf.h"
#include "importer/fit/pca.h"
#include "material/mu.h"

namespace loden::importer {

// Minimises sum over views and lights of |(A_v r) Y_v - C_v|^2 for the Y that the asset gives.
// `luma`, `chroma`: texels x (views * lights). `start` fills texels that no view sees. Returns flat_texels values.
std::vector<double> fitRatio(const ColumnBlocks& luma, const ColumnBlocks& chroma, const Indirection& a, double start,
                             int threads);

// (Cb/Y, Cr/Y) per flat texel for the luma `mean` + (A_v weights) basis^T; `mean` as sampleMean gives it.
std::vector<glm::dvec2> fitRatios(const YccBtf& btf, const Factors& luma, const Matrix& mean, const PhongMean& phong,
                                  const Indirection& a, int threads);

}  // namespace loden::importer
