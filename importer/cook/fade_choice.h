// Where the bands take over from the near term: chosen by measuring both against the BTF.
#pragma once

#include "importer/fit/ycc_btf.h"
#include "material/model/material.h"

namespace loden::importer {

struct FadeTrial {
  int level = 0;  // of detail
  double near_mse = 0,
         band_mse = 0;  // of Y, white at most: two evaluations of the near term alone, one of the bands alone
  double product = 0;   // mean product of their errors
  // Of the blend with the near term's weight w.
  double mse(double w) const {
    return w * w * near_mse + (1 - w) * (1 - w) * band_mse + 2 * w * (1 - w) * product;
  }
};

// Sets fade_begin and fade_end of a material with surface maps and bands to the window whose blend has the
// least product of errors over the levels 1 to 3, of those that leave the near term alone up to lambda .25 at
// least and the bands alone from lambda 3 on; returns what was measured. The errors of both are unlike, so
// that a blend is better than either over some levels. Deterministic at any number of threads.
std::vector<FadeTrial> chooseFade(Material& material, const YccBtf& btf, const DirectionSet& lights,
                                  const DirectionSet& views, int threads);

}  // namespace loden::importer
