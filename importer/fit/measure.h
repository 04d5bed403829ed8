// The error of a material against its input at the sampled directions and texel centres, by the algebra of
// its stored bands (equal to the evaluator, which a test holds it to, at a fraction of the time).
#pragma once

#include <string>

#include "importer/fit/indirection.h"
#include "importer/fit/ycc_btf.h"
#include "material/model/material.h"

namespace loden::importer {

struct FitError {
  double mse = 0, mae = 0;
  double rmse() const;
};

// Lab distances (CIE76, material/model/color.h), those of black samples of the BTF also apart.
struct LabSums {
  double lab = 0, black_lab = 0;
  int64_t count = 0, black_count = 0;
  void merge(const LabSums& other);
  double mean() const { return count ? lab / double(count) : 0; }
  double blackMean() const { return black_count ? black_lab / double(black_count) : 0; }
  double litMean() const { return count > black_count ? (lab - black_lab) / double(count - black_count) : 0; }
};
// Of one view's values, texels x lights for each of Y, Cb, Cr, at every n-th light, from light `view` modulo
// n; colours below zero count as zero.
LabSums labOfView(const YccBtf& btf, int view, const Matrix (&value)[3], int every);

struct BtfError {
  FitError channel[3];  // Y, Cb, Cr over all texels and pairs
  // Per image: the smallest and largest mean square error.
  double min_image_mse[3] = {0, 0, 0}, max_image_mse[3] = {0, 0, 0};
  LabSums lab;  // where it is asked for
};

// At lambda 0, of modes kLod and kFused. `a`: the flat domain's lookup; may be empty if no band is flat.
// lab_every: of every n-th light of each view the Lab distance too, which takes long; 0: none.
BtfError measureError(const Material& material, const YccBtf& btf, const DirectionSet& lights,
                      const DirectionSet& views, const Indirection& a, int threads, int lab_every = 0);

}  // namespace loden::importer
