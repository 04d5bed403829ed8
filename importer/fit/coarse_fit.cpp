#include "importer/fit/coarse_fit.h"

#include <cmath>

#include "importer/fit/band_fit.h"
#include "importer/fit/eigen.h"
#include "importer/fit/flat_fit.h"

namespace loden::importer {
namespace {

constexpr double kGrowth = 2;

// Sides of the levels from `side` down to 1.
std::vector<int> levelSides(int side) {
  std::vector<int> sides{side};
  while (side > 1) sides.push_back(side /= 2);
  return sides;
}

// All levels below each other, multiplied so that the sum of squares weighs the mean squared errors of the levels
// 1 : kGrowth : kGrowth^2 and so on.
ColumnBlocks stackedLevels(const ColumnBlocks& finest, int side) {
  const std::vector<int> sides = levelSides(side);
  int rows = 0;
  for (const int s : sides) rows += s * s;
  return {rows, finest.blocks, finest.block_cols, [finest, sides, rows](int v, Matrix& into) {
            Matrix level;
            finest.read(v, level);
            into = Matrix(rows, finest.block_cols);
            int row = 0;
            for (size_t k = 0; k < sides.size(); row += sides[k] * sides[k], ++k) {
              if (k > 0) level = downsample(level, sides[k - 1], BoxFilter::k2x2);
              const double scale = double(sides[0]) / double(sides[k]) * std::pow(kGrowth, double(k) / 2);
              eigen(into).middleRows(row, level.rows) = scale * eigen(level);
            }
          }};
}
Matrix stackedLevels(const Matrix& finest, int side) {
  Matrix out;
  stackedLevels(blocksOf(finest), side).read(0, out);
  return out;
}

// f * basis, block by block. Of data without its mean over the rows it has none either, so that what the coarsest
// level stores is exactly zero; the weights of a randomised factorization only nearly have that.
Matrix projected(const ColumnBlocks& f, const Matrix& basis) {
  Matrix weights(f.rows, basis.cols), block;
  for (int b = 0; b < f.blocks; ++b) {
    f.read(b, block);
    eigen(weights).noalias() += eigen(block) * eigen(basis).middleRows(Eigen::Index(b) * f.block_cols, f.block_cols);
  }
  return weights;
}

Factors fitChannel(const ColumnBlocks& finest, int side, int components, const DirectionSet& lights, const DirectionSet& views,
                   const CoarseFitOptions& options) {
  const ColumnBlocks levels = stackedLevels(finest, side);
  Matrix weights(finest.rows, components);
  eigenCols(weights, 0, 1).setOnes();
  if (components > 1) {
    const std::vector<double> mean = columnMeans(finest, options.threads);
    const ColumnBlocks centred = withoutMeans(finest, mean);
    const Matrix basis = leadingFactors(stackedLevels(centred, side), components - 1, options.threads).basis;
    eigenCols(weights, 1, components - 1) = eigen(projected(centred, basis));
  }
  const Indirection straight = identityIndirection(levels.rows, levels.blocks);
  return {weights, solveGridBasis(levels, straight, stackedLevels(weights, side), options.grid, lights, views, options.threads)};
}

}  // namespace

BandFactors fitCoarse(const YccBtf& half, const DirectionSet& lights, const DirectionSet& views, const Matrix& mean,
                      const CoarseFitOptions& options) {
  BandFactors factors;
  factors.side = half.side();
  factors.on_grid = true;
  factors.y = fitChannel(centredBlocks(half, 0, mean), half.side(), options.y_components, lights, views, options);
  return factors;
}

}  // namespace loden::importer
