#include "importer/fit/coarse_fit.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <cmath>

#include "importer/fit/band_fit.h"
#include "importer/fit/eigen.h"
#include "importer/fit/flat_fit.h"
#include "importer/fit/grid_table.h"

namespace loden::importer {
namespace {

constexpr double kGrowth = 2;
constexpr int kTriedColumns = 3, kFewestColumns = 5;
// The first quads serve the levels from these lambdas on, the first of them the farthest. Levels of at most
// kFewestTexels along a side are served by all.
constexpr int kServedFrom[] = {4, 3, 2, 1};
constexpr int kFewestTexels = 4;

// Sides of the levels from `side` down to 1.
std::vector<int> levelSides(int side) {
  std::vector<int> sides{side};
  while (side > 1) sides.push_back(side /= 2);
  return sides;
}

// What a level of side `coarse` is multiplied by so that sums of squares weigh the mean squared errors of the
// levels, from the finest on, 1 : kGrowth : kGrowth^2 and so on.
double levelScale(int finest, int coarse) {
  const double ratio = double(finest) / double(coarse);
  return ratio * std::pow(kGrowth, std::log2(ratio) / 2);
}

// The given levels below each other, from the one of `side` texels on, each times its levelScale.
ColumnBlocks stacked(const std::vector<ColumnBlocks>& levels, int side) {
  int rows = 0;
  for (const ColumnBlocks& level : levels) rows += level.rows;
  const ColumnBlocks& finest = levels.front();
  return {rows, finest.blocks, finest.block_cols, [levels, side, rows](int v, Matrix& into) {
            Matrix block;
            into = Matrix(rows, levels.front().block_cols);
            int row = 0;
            for (const ColumnBlocks& level : levels) {
              level.read(v, block);
              const int coarse = static_cast<int>(std::lround(std::sqrt(double(level.rows))));
              eigen(into).middleRows(row, level.rows) = levelScale(side, coarse) * eigen(block);
              row += level.rows;
            }
          }};
}

// All levels, which are means of the finest, below each other in the same way.
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
              eigen(into).middleRows(row, level.rows) = levelScale(sides[0], sides[k]) * eigen(level);
            }
          }};
}
Matrix stackedLevels(const Matrix& finest, int side) {
  Matrix out;
  stackedLevels(blocksOf(finest), side).read(0, out);
  return out;
}

// f * basis, block by block. Of data without its mean over the rows it has none either, so that what the
// coarsest level stores is exactly zero; the weights of a randomised factorization only nearly have that.
Matrix projected(const ColumnBlocks& f, const Matrix& basis) {
  Matrix weights(f.rows, basis.cols), block;
  for (int b = 0; b < f.blocks; ++b) {
    f.read(b, block);
    eigen(weights).noalias() +=
        eigen(block) * eigen(basis).middleRows(Eigen::Index(b) * f.block_cols, f.block_cols);
  }
  return weights;
}

// Turns the components after the first, whose weight is 1 everywhere, so that the leading quads hold what the
// coarse levels need: of all rotations of what these components span, the one that leaves the first quad's
// error least over its levels, then the second's over its own, and so on. All components together give the
// same as before; far away one or two quads do.
void serveCoarseLevelsFirst(Matrix& weights, int side) {
  const int count = weights.cols - 1;
  // Per quad, the squares of its levels.
  std::vector<Eigen::MatrixXd> squares(std::size(kServedFrom), Eigen::MatrixXd::Zero(count, count));
  Matrix level = weights;
  for (int s = side, lambda = 1; s > 1; s /= 2, ++lambda) {
    if (s < side) level = downsample(level, 2 * s, BoxFilter::k2x2);
    const Eigen::MatrixXd scaled = levelScale(side, s) * eigenCols(level, 1, count);
    for (size_t quad = 0; quad < squares.size(); ++quad)
      if (lambda >= kServedFrom[quad] || s <= kFewestTexels)
        squares[quad].noalias() += scaled.transpose() * scaled;
  }
  Eigen::MatrixXd rotation = Eigen::MatrixXd::Identity(count, count);
  int done = 0;
  for (size_t quad = 0; quad < squares.size() && done < count; ++quad) {
    const int rest = count - done, taken = std::min(quad == 0 ? 3 : 4, rest);
    const Eigen::MatrixXd open = rotation.rightCols(rest);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(open.transpose() * squares[quad] * open);
    rotation.rightCols(rest) = open * solver.eigenvectors().rowwise().reverse();
    done += taken;
  }
  eigenCols(weights, 1, count) = eigenCols(weights, 1, count) * rotation;
}

Factors fitChannel(const ColumnBlocks& finest, int side, int components, const DirectionSet& lights,
                   const DirectionSet& views, const CoarseFitOptions& options) {
  const ColumnBlocks levels = stackedLevels(finest, side);
  Matrix weights(finest.rows, components);
  eigenCols(weights, 0, 1).setOnes();
  if (components > 1) {
    const std::vector<double> mean = columnMeans(finest, options.threads);
    const ColumnBlocks centred = withoutMeans(finest, mean);
    const Matrix basis = leadingFactors(stackedLevels(centred, side), components - 1, options.threads).basis;
    eigenCols(weights, 1, components - 1) = eigen(projected(centred, basis));
    serveCoarseLevelsFirst(weights, side);
  }
  const Indirection straight = identityIndirection(levels.rows, levels.blocks);
  return {weights, solveGridBasis(levels, straight, stackedLevels(weights, side), options.grid, lights, views,
                                  options.threads)};
}

// samples x samples: the nearest values that a grid can give.
Eigen::MatrixXd gridProjection(const DirectionGrid& grid, const DirectionSet& set) {
  const Matrix sampling = gridSampling(grid, set);
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(eigen(sampling));
  const Eigen::MatrixXd q = Eigen::MatrixXd(qr.householderQ()).leftCols(qr.rank());
  return q * q.transpose();
}

}  // namespace

Factors fitCoarseChroma(const std::vector<ColumnBlocks>& levels, int side, const DirectionSet& lights,
                        const DirectionSet& views, const CoarseFitOptions& options) {
  const ColumnBlocks all = stacked(levels, side);
  const Matrix basis = leadingFactors(all, options.chroma_components, options.threads).basis;
  const Matrix weights = projected(levels.front(), basis);
  const Indirection straight = identityIndirection(all.rows, all.blocks);
  return {weights, solveGridBasis(all, straight, stackedLevels(weights, side), options.grid, lights, views,
                                  options.threads)};
}

DirectionGrid averageGrid(const Matrix& means, const Matrix& mean, const DirectionSet& lights,
                          const DirectionSet& views, int phis) {
  Eigen::MatrixXd rest(lights.size(), views.size());
  for (int v = 0; v < views.size(); ++v)
    for (int l = 0; l < lights.size(); ++l)
      rest(l, v) = means(v * lights.size() + l, 0) - mean(v * lights.size() + l, 0);
  DirectionGrid best = gridFor(lights, 6, phis);
  double least = INFINITY;
  for (int columns = phis; columns > phis - kTriedColumns && columns >= kFewestColumns; --columns) {
    const DirectionGrid grid = gridFor(lights, 6, columns);
    const double misfit =
        (gridProjection(grid, lights) * rest * gridProjection(grid, views) - rest).squaredNorm();
    if (misfit >= least) continue;
    least = misfit;
    best = grid;
  }
  return best;
}

BandFactors fitCoarse(const YccBtf& half, const DirectionSet& lights, const DirectionSet& views,
                      const Matrix& mean, const CoarseFitOptions& options) {
  BandFactors factors;
  factors.side = half.side();
  factors.on_grid = true;
  factors.y =
      fitChannel(centredBlocks(half, 0, mean), half.side(), options.y_components, lights, views, options);
  return factors;
}

}  // namespace loden::importer
