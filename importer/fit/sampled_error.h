// Measures the error of a material against samples of its input (importer/fit/ycc_btf.h) by the evaluator.
#pragma once

#include <vector>

#include "importer/fit/measure.h"
#include "importer/fit/ycc_btf.h"
#include "material/eval/evaluate.h"

namespace loden::importer {

struct SampledError {
  FitError channel[3];  // Y, Cb, Cr
  double lab = 0;       // mean Lab distance, CIE76
};

// The error at these samples of a BTF of the material's side. Since a texel of a BTF is the mean over its
// area, the material's value is the mean of points x points evaluations in the texel, at the level of detail
// where one texel covers the distance between them. Deterministic at any number of threads.
SampledError sampledError(const Evaluator& evaluator, const std::vector<BtfSample>& samples,
                          const DirectionSet& lights, const DirectionSet& views, int points, int threads);

}  // namespace loden::importer
