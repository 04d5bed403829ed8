#include "importer/fit/ratio_fit.h"

#include "importer/fit/band_fit.h"
#include "importer/fit/eigen.h"
#include "importer/fit/reduction.h"

namespace loden::importer {
namespace {

constexpr int kSteps = 40;      // conjugate gradients on a well conditioned, diagonally dominant system
constexpr double kPull = 1e-4;  // towards the start, relative to the mean weight of a texel

// Light of which chroma is seen no better, white = 1.
constexpr double kDark = 0.02;

// Weight of a squared error of chroma beside luma y. What is seen of it goes with the slope of the cube root
// (CIE Lab), y^(-2/3); unweighted, a few highlights would decide the colour of all that is darker.
Eigen::ArrayXXd visible(const Eigen::ArrayXXd& y) {
  return (y + kDark).pow(-4.0 / 3.0);
}

// Per view and texel: weighted sum over lights of Y^2 and of Y C.
struct Moments {
  Matrix yy, yc;  // texels x views
};

Moments moments(const ColumnBlocks& luma, const ColumnBlocks& chroma, int threads) {
  Moments m{Matrix(luma.rows, luma.blocks), Matrix(luma.rows, luma.blocks)};
  parallelFor(luma.blocks, threads, [&](int v) {
    Matrix y, c;
    luma.read(v, y);
    chroma.read(v, c);
    const Eigen::ArrayXXd seen = eigen(y).array();
    const Eigen::ArrayXXd weighted = visible(seen) * seen;
    eigenCols(m.yy, v, 1) = (weighted * seen).rowwise().sum().matrix();
    eigenCols(m.yc, v, 1) = (weighted * eigen(c).array()).rowwise().sum().matrix();
  });
  return m;
}

}  // namespace

std::vector<double> fitRatio(const ColumnBlocks& luma, const ColumnBlocks& chroma, const Indirection& a,
                             double start, int threads) {
  using Eigen::VectorXd;
  const Moments m = moments(luma, chroma, threads);
  Matrix right(a.flat_texels, 1), diagonal(a.flat_texels, 1), product(a.texels, 1);
  for (int v = 0; v < a.views; ++v) {
    eigen(product) = eigenCols(m.yc, v, 1);
    a.addTransposed(v, product, right);
    eigen(product) = eigenCols(m.yy, v, 1);
    a.addTransposed(v, product, diagonal);
  }
  const double pull = kPull * eigen(diagonal).mean() + 1e-300;
  auto normal = [&](const Matrix& r) -> VectorXd {
    Matrix sum(a.flat_texels, 1), seen, weighted(a.texels, 1);
    for (int v = 0; v < a.views; ++v) {
      a.apply(v, r, seen);
      eigen(weighted) = eigen(seen).cwiseProduct(eigenCols(m.yy, v, 1));
      a.addTransposed(v, weighted, sum);
    }
    return eigen(sum) + pull * eigen(r);
  };
  Matrix r(a.flat_texels, 1);
  eigen(r).setConstant(start);
  const VectorXd scale = (eigen(diagonal).array() + pull).matrix();
  VectorXd residual = eigen(right) + pull * eigen(r) - normal(r);
  VectorXd z = residual.cwiseQuotient(scale);
  Matrix direction = matrixFrom(z);
  double rz = residual.dot(z);
  for (int step = 0; step < kSteps && rz > 0; ++step) {
    const VectorXd q = normal(direction);
    const double alpha = rz / eigen(direction).col(0).dot(q);
    eigen(r) += alpha * eigen(direction);
    residual -= alpha * q;
    z = residual.cwiseQuotient(scale);
    const double next = residual.dot(z);
    eigen(direction) = z + next / rz * eigen(direction);
    rz = next;
  }
  return r.data;
}

ColumnBlocks wholeLuma(const YccBtf& btf, const Factors& luma, const Matrix& mean, const Indirection& a) {
  return {btf.texels(), btf.views(), btf.lights(), [&btf, &luma, &mean, &a](int v, Matrix& into) {
            Matrix seen;
            a.apply(v, luma.weights, seen);
            const Eigen::Index first = Eigen::Index(v) * btf.lights();
            if (into.rows != btf.texels() || into.cols != btf.lights())
              into = Matrix(btf.texels(), btf.lights());
            eigen(into).noalias() =
                eigen(seen) * eigen(luma.basis).middleRows(first, btf.lights()).transpose();
            eigen(into).rowwise() += eigen(mean).col(0).segment(first, btf.lights()).transpose();
            eigen(into) = eigen(into).cwiseMax(0.0);
          }};
}

std::vector<glm::dvec2> fitRatios(const YccBtf& btf, const ColumnBlocks& luma, const PhongMean& phong,
                                  const Indirection& a, int threads) {
  std::vector<glm::dvec2> ratios(size_t(a.flat_texels));
  for (int c = 0; c < 2; ++c) {
    const double start = phong.chroma == MeanChroma::kRatio ? double(c == 0 ? phong.cb : phong.cr) : 0.0;
    const std::vector<double> r = fitRatio(luma, channelBlocks(btf, c + 1), a, start, threads);
    for (size_t t = 0; t < r.size(); ++t) ratios[t][c] = r[t];
  }
  return ratios;
}

ColumnBlocks ratioResidual(const YccBtf& btf, int channel, const ColumnBlocks& luma,
                           const std::vector<glm::dvec2>& ratios, const Indirection& a) {
  Matrix ratio(a.flat_texels, 1);
  for (int t = 0; t < ratio.rows; ++t) ratio(t, 0) = ratios[size_t(t)][channel - 1];
  return {btf.texels(), btf.views(), btf.lights(),
          [&btf, &a, channel, luma, ratio = std::move(ratio)](int v, Matrix& into) {
            Matrix whole, seen;
            luma.read(v, whole);
            a.apply(v, ratio, seen);
            btf.read(channel, v, into);
            eigen(into) -= eigen(seen).col(0).asDiagonal() * eigen(whole);
          }};
}

}  // namespace loden::importer
