// What each level of detail is shown by: where the bands take over from the near term, and how many quads of
// the coarsest band are read. Chosen by measuring against the BTF.
#pragma once

#include <vector>

#include "importer/fit/ycc_btf.h"
#include "material/model/material.h"

namespace loden::importer {

// Mean squared errors of Y at one level of detail. Y is white at most, as displays show it, so that single
// peaks do not decide.
struct LevelTrial {
  // Of the bands of which the coarsest has but its first quads.
  struct Quads {
    double mse = 0;
    double product = 0;  // mean product of this error and the near term's
  };
  int level = 0;
  double near_mse = 0;       // of the near term alone; 0 beyond the levels it may be shown at
  std::vector<Quads> quads;  // at k the first k + 1
  double bands_mse() const { return quads.back().mse; }  // of all quads
  // Of the blend with the near term's weight w and the first `count` quads.
  double mse(double w, size_t count) const {
    const Quads& bands = quads[count - 1];
    return w * w * near_mse + (1 - w) * (1 - w) * bands.mse + 2 * w * (1 - w) * bands.product;
  }
};

// For a material with bands, the coarsest of which has no chroma quads, in this order:
// - With surface maps, sets fade_begin and fade_end. The errors of near term and bands are unlike, so that a
//   blend is closer than either, but costs as much as both: of the windows whose mean error over lambda 1 to
//   3 is at most kFadeLoss above the least, the narrowest. They leave the near term alone up to lambda .25 at
//   least, and the bands alone from lambda 3 on.
// - Sets the coarsest band's quad_levels so that each level reads the fewest quads with which the error of
//   what is shown is at most kQuadLoss above that of all of them, kBlendLoss where the near term shows as
//   well, or below kQuadFloor.
// Returns what was measured, from level 1 on. Deterministic at any number of threads.
inline constexpr double kFadeLoss = 0.03;
inline constexpr double kQuadLoss = 0.1;
inline constexpr double kBlendLoss = 0.03;
inline constexpr double kQuadFloor = 0.0125;  // root mean square, white = 1: 38 dB
std::vector<LevelTrial> chooseLevels(Material& material, const YccBtf& btf, const DirectionSet& lights,
                                     const DirectionSet& views, int threads);

}  // namespace loden::importer
