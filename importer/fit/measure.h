// Measures the error of a material against its input at the sampled directions and texel centres, by matrix
// products of its stored bands. The result equals that of the evaluator, as a test checks, in a fraction of
// the time.
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

// Sums of Lab distances (CIE76, material/model/color.h), with those of black samples of the BTF also summed
// apart.
struct LabSums {
  double lab = 0, black_lab = 0;
  int64_t count = 0, black_count = 0;
  void merge(const LabSums& other);
  double mean() const { return count ? lab / double(count) : 0; }
  double blackMean() const { return black_count ? black_lab / double(black_count) : 0; }
  double litMean() const { return count > black_count ? (lab - black_lab) / double(count - black_count) : 0; }
};
// The Lab distances of one view's values, texels x lights for each of Y, Cb, Cr, at every n-th light,
// starting at light `view` modulo n. Colours below zero count as zero.
LabSums labOfView(const YccBtf& btf, int view, const Matrix (&value)[3], int every);

struct BtfError {
  FitError channel[3];  // Y, Cb, Cr over all texels and pairs
  // Per image: the smallest and largest mean square error.
  double min_image_mse[3] = {0, 0, 0}, max_image_mse[3] = {0, 0, 0};
  LabSums lab;  // only if lab_every is not 0
};

// The error at lambda 0 of a material of mode kLod or kFused. `a`: the look-up of the flat domain; may be
// empty if no band is flat. lab_every: if n > 0, the Lab distance is measured at every n-th light of each
// view, which takes long; 0: not at all.
BtfError measureError(const Material& material, const YccBtf& btf, const DirectionSet& lights,
                      const DirectionSet& views, const Indirection& a, int threads, int lab_every = 0);

}  // namespace loden::importer
