#include "importer/fit/indirection.h"

#include <cmath>

#include "importer/fit/reduction.h"
#include "material/base/check.h"

namespace loden::importer {
namespace {

Indirection::Taps bilinearTaps(glm::dvec2 p, int side) {
  const glm::dvec2 texel = (p - glm::floor(p)) * double(side) - 0.5;
  const glm::dvec2 base = glm::floor(texel), f = texel - base;
  const auto wrap = [side](double i) { return (static_cast<int>(i) + side) % side; };
  const int x0 = wrap(base.x), x1 = wrap(base.x + 1), y0 = wrap(base.y), y1 = wrap(base.y + 1);
  return {{y0 * side + x0, y0 * side + x1, y1 * side + x0, y1 * side + x1},
          {float((1 - f.x) * (1 - f.y)), float(f.x * (1 - f.y)), float((1 - f.x) * f.y), float(f.x * f.y)}};
}

}  // namespace

void Indirection::apply(int view, const Matrix& flat, Matrix& into) const {
  LODEN_CHECK_EQ(flat.rows, flat_texels);
  if (into.rows != texels || into.cols != flat.cols) into = Matrix(texels, flat.cols);
  const Taps* of_view = taps.data() + size_t(view) * size_t(texels);
  for (int k = 0; k < flat.cols; ++k) {
    const double* source = flat.col(k).data();
    double* target = into.col(k).data();
    for (int x = 0; x < texels; ++x) {
      const Taps& t = of_view[x];
      target[x] = double(t.weight[0]) * source[t.index[0]] + double(t.weight[1]) * source[t.index[1]] +
                  double(t.weight[2]) * source[t.index[2]] + double(t.weight[3]) * source[t.index[3]];
    }
  }
}

void Indirection::addTransposed(int view, const Matrix& values, Matrix& sum) const {
  LODEN_CHECK_EQ(values.rows, texels);
  LODEN_CHECK_EQ(sum.rows, flat_texels);
  const Taps* of_view = taps.data() + size_t(view) * size_t(texels);
  for (int k = 0; k < values.cols; ++k) {
    const double* source = values.col(k).data();
    double* target = sum.col(k).data();
    for (int x = 0; x < texels; ++x)
      for (int i = 0; i < 4; ++i) target[of_view[x].index[i]] += double(of_view[x].weight[i]) * source[x];
  }
}

Indirection makeIndirection(int side, int flat_side, const DirectionSet& views,
                            const IndirectionLookup& lookup, int threads) {
  Indirection a{side * side, flat_side * flat_side, views.size(), {}};
  a.taps.resize(size_t(a.views) * size_t(a.texels));
  parallelFor(a.views, threads, [&](int v) {
    for (int t = 0; t < a.texels; ++t) {
      const glm::dvec2 x((t % side + 0.5) / side, (t / side + 0.5) / side);
      a.taps[size_t(v) * size_t(a.texels) + size_t(t)] =
          bilinearTaps(lookup(x, views.samples[size_t(v)]), flat_side);
    }
  });
  return a;
}

Indirection identityIndirection(int texels, int views) {
  Indirection a{texels, texels, views, {}};
  a.taps.resize(size_t(views) * size_t(texels));
  for (size_t i = 0; i < a.taps.size(); ++i) {
    const auto t = static_cast<int32_t>(i % size_t(texels));
    a.taps[i] = {{t, t, t, t}, {1, 0, 0, 0}};
  }
  return a;
}

}  // namespace loden::importer
