// Chooses what shows each level of detail: where the bands take over from the near term, and how many quads
// of the coarsest band are read. Both are chosen by measuring against the BTF.
#pragma once

#include <vector>

#include "importer/fit/ycc_btf.h"
#include "material/model/material.h"

namespace loden::importer {

// Mean squared errors at one level of detail, over the channels of linear RGB. Values are clamped to white,
// as displays show them, so that single peaks do not decide.
struct LevelTrial {
  // Errors of the bands, if only the first quads of the coarsest one are read.
  struct Quads {
    double mse = 0;
    double product = 0;  // mean product of this error and that of the near term
  };
  int level = 0;
  double near_mse = 0;       // error of the near term alone; 0 beyond the levels at which it may be shown
  std::vector<Quads> quads;  // entry k: the first k + 1 quads are read
  double bands_mse() const { return quads.back().mse; }  // the bands' error with all quads
  // The error of the blend of the near term with weight w and the bands with the first `count` quads.
  double mse(double w, size_t count) const {
    const Quads& bands = quads[count - 1];
    return w * w * near_mse + (1 - w) * (1 - w) * bands.mse + 2 * w * (1 - w) * bands.product;
  }
};

// Chooses the levels of a material with bands, in two steps:
// - With surface maps it sets fade_begin and fade_end. The errors of near term and bands differ, so that a
//   blend is closer than either alone, but costs as much as both. Of the windows whose mean error over lambda
//   1 to 3 is at most kFadeLoss above the least, it takes the narrowest. Every window leaves the near term
//   alone up to lambda .25 at least, and the bands alone from lambda 3 on.
// - It sets the coarsest band's quad_levels so that each level reads the fewest quads with which the error of
//   what is shown is at most kQuadLoss above that of all quads (kBlendLoss where the near term is visible
//   too), or below kQuadFloor.
// `half` is the BTF at half the side, which is level 1. Returns the measurements, from level 1 on.
// Deterministic at any number of threads.
inline constexpr double kFadeLoss = 0.03;
inline constexpr double kQuadLoss = 0.1;
inline constexpr double kBlendLoss = 0.03;
inline constexpr double kQuadFloor = 0.0175;  // root mean square, white = 1: 35 dB
std::vector<LevelTrial> chooseLevels(Material& material, const YccBtf& half, const DirectionSet& lights,
                                     const DirectionSet& views, int threads);

// The geometric mean of the root mean square errors of what a material shows from lambda 1 to 3, with all
// quads; `trials` is what chooseLevels returned for it.
double shownRmse(const Material& material, const std::vector<LevelTrial>& trials);

}  // namespace loden::importer
