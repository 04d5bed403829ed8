// Fits the mean mu: Levenberg-Marquardt on LBTF eq. 5 for Y, constants or ratios for Cb and Cr.
#pragma once

#include "importer/fit/matrix.h"
#include "material/model/directions.h"
#include "material/model/mu.h"

namespace loden::importer {

struct PhongOptions {
  bool constrained = false;  // kd, ks >= 0; false: as published
  MeanChroma chroma = MeanChroma::kConstant;
};

struct PhongFit {
  PhongMean mean;
  double rmse = 0;  // RMSE of Y over the samples
};

// The fitted mean. `means`: (views * lights) x 3 of Y, Cb, Cr; row = view * lights + light.
PhongFit fitPhong(const Matrix& means, const DirectionSet& lights, const DirectionSet& views,
                  const PhongOptions& options);

// The values of the fitted mean at the samples: (views * lights) x 3.
Matrix sampleMean(const PhongMean& mean, const DirectionSet& lights, const DirectionSet& views);

}  // namespace loden::importer
