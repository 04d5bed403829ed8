#include "importer/fit/measure.h"

#include <cmath>

#include "importer/fit/band_pack.h"
#include "importer/fit/eigen.h"
#include "importer/fit/phong.h"
#include "importer/fit/reduction.h"
#include "material/model/color.h"

namespace loden::importer {
namespace {

using Eigen::MatrixXd;

// Reference texels of the finest level that read a coarse map without filtering, as kNearest bands do.
Matrix spread(const Matrix& coarse, int coarse_side, int side) {
  Matrix out(side * side, coarse.cols);
  const int step = side / coarse_side;
  for (int k = 0; k < coarse.cols; ++k)
    for (int t = 0; t < out.rows; ++t) out(t, k) = coarse(t / side / step * coarse_side + t % side / step, k);
  return out;
}

struct DecodedBand {
  BandFactors factors;
  bool flat = false;
};

Matrix weightsFor(const DecodedBand& band, const Matrix& weights, const Indirection& a, int view, int side) {
  Matrix out;
  if (band.flat)
    a.apply(view, weights, out);
  else
    out = spread(weights, band.factors.side, side);
  return out;
}

// texels x lights of one view, channel by channel.
void addBand(const DecodedBand& band, const Indirection& a, int view, int side, int lights,
             const Matrix& mean, MatrixXd (&total)[3]) {
  const Factors* factors[3] = {&band.factors.y, &band.factors.cb, &band.factors.cr};
  const auto mean_of_view = eigen(mean).middleRows(Eigen::Index(view) * lights, lights);
  MatrixXd value[3];
  for (MatrixXd& v : value) v = MatrixXd::Zero(side * side, lights);
  MatrixXd luma = MatrixXd::Zero(side * side, lights);
  for (int channel = 0; channel < 3; ++channel) {
    const Factors& f = *factors[channel];
    if (f.components() == 0) continue;
    const Matrix weights = weightsFor(band, f.weights, a, view, side);
    const auto basis = eigen(f.basis).middleRows(Eigen::Index(view) * lights, lights);
    const MatrixXd part = eigen(weights) * basis.transpose();
    value[channel] += part;
    if (channel == 0) luma = part;
  }
  if (!band.factors.ratio.empty()) {
    Matrix ratio(static_cast<int>(band.factors.ratio[0].size()), 2);
    for (int t = 0; t < ratio.rows; ++t)
      for (int c = 0; c < 2; ++c) ratio(t, c) = band.factors.ratio[0][size_t(t)][c];
    const Matrix seen = weightsFor(band, ratio, a, view, side);
    const MatrixXd whole = luma.rowwise() + mean_of_view.col(0).transpose();
    for (int c = 0; c < 2; ++c) {
      value[c + 1] += eigenCols(seen, c, 1).asDiagonal() * whole;
      value[c + 1].rowwise() -= mean_of_view.col(c + 1).transpose();
    }
  }
  for (int c = 0; c < 3; ++c) total[c] += value[c];
}

// As the evaluator gives them: no colour below zero.
void clampAtZero(MatrixXd (&value)[3]) {
  for (Eigen::Index i = 0; i < value[0].size(); ++i) {
    const glm::dvec3 rgb = rgbFromYcc(glm::dvec3(value[0].data()[i], value[1].data()[i], value[2].data()[i]));
    if (rgb.x >= 0 && rgb.y >= 0 && rgb.z >= 0) continue;
    const glm::dvec3 ycc = yccFromRgb(glm::max(rgb, glm::dvec3(0)));
    for (int c = 0; c < 3; ++c) value[c].data()[i] = ycc[c];
  }
}

struct ViewError {
  double squares[3] = {0, 0, 0}, absolute[3] = {0, 0, 0}, least[3], most[3];
};

ViewError errorOfView(const YccBtf& btf, int view, const MatrixXd (&value)[3]) {
  ViewError error;
  Matrix truth;
  for (int channel = 0; channel < 3; ++channel) {
    btf.read(channel, view, truth);
    const MatrixXd difference = value[channel] - eigen(truth);
    const Eigen::RowVectorXd images = difference.colwise().squaredNorm() / double(btf.texels());
    error.squares[channel] = difference.squaredNorm();
    error.absolute[channel] = difference.cwiseAbs().sum();
    error.least[channel] = images.minCoeff();
    error.most[channel] = images.maxCoeff();
  }
  return error;
}

}  // namespace

void LabSums::merge(const LabSums& other) {
  lab += other.lab, black_lab += other.black_lab;
  count += other.count, black_count += other.black_count;
}

LabSums labOfView(const YccBtf& btf, int view, const Matrix (&value)[3], int every) {
  Matrix truth[3];
  for (int c = 0; c < 3; ++c) btf.read(c, view, truth[c]);
  LabSums sums;
  for (int l = view % every; l < btf.lights(); l += every)
    for (int t = 0; t < btf.texels(); ++t) {
      const glm::dvec3 rgb = rgbFromYcc(glm::dvec3(truth[0](t, l), truth[1](t, l), truth[2](t, l)));
      const glm::dvec3 given =
          glm::max(rgbFromYcc(glm::dvec3(value[0](t, l), value[1](t, l), value[2](t, l))), glm::dvec3(0));
      const double distance = glm::distance(labFromRgb(rgb), labFromRgb(given));
      const bool black = truth[0](t, l) == 0;
      sums.lab += distance, ++sums.count;
      if (black) sums.black_lab += distance, ++sums.black_count;
    }
  return sums;
}

double FitError::rmse() const {
  return std::sqrt(mse);
}

BtfError measureError(const Material& material, const YccBtf& btf, const DirectionSet& lights,
                      const DirectionSet& views, const Indirection& a, int threads, int lab_every) {
  std::vector<DecodedBand> bands;
  for (const Band& band : material.bands)
    if (windowWeight(band.window, 0.0f) > 0)
      bands.push_back({unpackBand(band, tableGrid(band, material.theta_max), lights, views),
                       band.domain == Domain::kFlat});
  const Matrix mean = sampleMean(material.mean, lights, views);
  std::vector<ViewError> errors(size_t(btf.views()));
  std::vector<LabSums> labs(size_t(btf.views()));
  parallelFor(btf.views(), threads, [&](int v) {
    MatrixXd value[3];
    for (int c = 0; c < 3; ++c)
      value[c] = MatrixXd::Ones(btf.texels(), 1) *
                 eigen(mean).col(c).segment(Eigen::Index(v) * btf.lights(), btf.lights()).transpose();
    for (const DecodedBand& band : bands) addBand(band, a, v, btf.side(), btf.lights(), mean, value);
    clampAtZero(value);
    errors[size_t(v)] = errorOfView(btf, v, value);
    if (lab_every > 0)
      labs[size_t(v)] =
          labOfView(btf, v, {matrixFrom(value[0]), matrixFrom(value[1]), matrixFrom(value[2])}, lab_every);
  });
  BtfError total;
  for (const LabSums& of_view : labs) total.lab.merge(of_view);
  const double values = double(btf.texels()) * btf.lights() * btf.views();
  for (int c = 0; c < 3; ++c) {
    total.min_image_mse[c] = INFINITY;
    for (const ViewError& e : errors) {
      total.channel[c].mse += e.squares[c] / values;
      total.channel[c].mae += e.absolute[c] / values;
      total.min_image_mse[c] = std::min(total.min_image_mse[c], e.least[c]);
      total.max_image_mse[c] = std::max(total.max_image_mse[c], e.most[c]);
    }
  }
  return total;
}

}  // namespace loden::importer
