#include <gtest/gtest.h>

#include "importer/fit/phong.h"

namespace loden::importer {
namespace {

TEST(Phong, RecoversItsOwnParameters) {
  const DirectionSet set = bonn81Directions();
  PhongMean truth;
  truth.ka = 0.02f, truth.kd = 0.6f, truth.ks = 0.3f, truth.alpha = 22;
  truth.cb = -0.03f, truth.cr = 0.08f, truth.chroma = MeanChroma::kRatio;
  for (bool constrained : {false, true}) {
    const PhongFit fit = fitPhong(sampleMean(truth, set, set), set, set, {constrained, MeanChroma::kRatio});
    EXPECT_NEAR(fit.mean.ka, truth.ka, 1e-5);
    EXPECT_NEAR(fit.mean.kd, truth.kd, 1e-5);
    EXPECT_NEAR(fit.mean.ks, truth.ks, 1e-5);
    EXPECT_NEAR(fit.mean.alpha, truth.alpha, 1e-3);
    EXPECT_NEAR(fit.mean.cb, truth.cb, 1e-6);
    EXPECT_NEAR(fit.mean.cr, truth.cr, 1e-6);
    EXPECT_LT(fit.rmse, 1e-6);
  }
}

TEST(Phong, ConstraintKeepsCoefficientsPositive) {
  const DirectionSet set = bonn81Directions();
  PhongMean dark;  // brighter towards grazing light: the free fit answers with negative kd
  dark.ka = 1, dark.kd = -0.5f, dark.ks = -0.2f, dark.alpha = 8;
  const Matrix means = sampleMean(dark, set, set);
  const PhongFit free = fitPhong(means, set, set, {false, MeanChroma::kConstant});
  EXPECT_LT(free.mean.kd, 0);
  const PhongFit kept = fitPhong(means, set, set, {true, MeanChroma::kConstant});
  EXPECT_GE(kept.mean.kd, 0);
  EXPECT_GE(kept.mean.ks, 0);
}

TEST(Phong, FitsAllZero) {
  const DirectionSet set = bonn81Directions();
  const PhongFit fit = fitPhong(Matrix(set.size() * set.size(), 3), set, set, {true, MeanChroma::kRatio});
  EXPECT_NEAR(fit.mean.ka, 0, 1e-9);
  EXPECT_NEAR(fit.mean.kd, 0, 1e-9);
  EXPECT_NEAR(fit.mean.cb, 0, 1e-9);
  EXPECT_LT(fit.rmse, 1e-9);
}

}  // namespace
}  // namespace loden::importer
