// Rays against the triangles of a geometry image, by a uniform grid of cells over one period in x and y.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "material/base/check.h"
#include "material/model/geometry_image.h"

namespace loden {
namespace {

struct Triangle {
  glm::dvec3 a, edge_b, edge_c;
  glm::dvec2 p, p_b, p_c;  // parameter of a, and its change along the edges
};

struct HeightBounds {
  float z_min = std::numeric_limits<float>::max(), z_max = std::numeric_limits<float>::lowest();

  void add(double lo, double hi) {
    z_min = std::min(z_min, static_cast<float>(lo) - 1e-6f);
    z_max = std::max(z_max, static_cast<float>(hi) + 1e-6f);
  }
  bool meets(double lo, double hi) const { return lo <= z_max && hi >= z_min; }
};

struct CellReference {
  uint32_t triangle = 0;
  glm::i16vec2 shift{0};  // add to the triangle to bring the copy into the base cell
  HeightBounds bounds;
};

struct LocalHit {
  double t = 0, u = 0, v = 0;
};

struct CellHit {
  LocalHit at;
  const Triangle* triangle = nullptr;
  glm::dvec2 shift{0};  // of the copy that is hit
};

// Moeller and Trumbore, with a tolerance that closes the seams between neighbours.
std::optional<LocalHit> intersect(const Triangle& tri, const glm::dvec3& o, const glm::dvec3& d) {
  constexpr double kSeam = 1e-9;
  const glm::dvec3 h = glm::cross(d, tri.edge_c);
  const double det = glm::dot(tri.edge_b, h);
  if (std::abs(det) < 1e-18) return std::nullopt;
  const double inv = 1 / det;
  const glm::dvec3 s = o - tri.a;
  const double u = glm::dot(s, h) * inv;
  if (u < -kSeam || u > 1 + kSeam) return std::nullopt;
  const glm::dvec3 q = glm::cross(s, tri.edge_b);
  const double v = glm::dot(d, q) * inv;
  if (v < -kSeam || u + v > 1 + kSeam) return std::nullopt;
  return LocalHit{glm::dot(tri.edge_c, q) * inv, u, v};
}

constexpr int kFewestCells = 8;  // per side of the grid

// Neighbouring texels this far apart, in tile periods, are a tear in a damaged image, not surface.
constexpr double kTear = 0.5;

bool torn(const glm::dvec3& edge) {
  return !(std::max(std::abs(edge.x), std::abs(edge.y)) < kTear);
}

uint32_t chartAt(const GeometryImage& image, int i, int j) {
  const auto* texels = reinterpret_cast<const uint16_t*>(image.texels.data.data());
  const int n = image.side();
  return texels[4 * (static_cast<size_t>(wrapIndex(j, n)) * static_cast<size_t>(n) +
                     static_cast<size_t>(wrapIndex(i, n))) +
                3];
}

// The surface over a patch, by (a, b) in [0,1]^2, as the cubic through the sixteen texels around it (Catmull
// and Rom 1974). At its corners it is the texels. Texels of another chart, or beyond a tear, are replaced by
// those that would go on straight, along the row or the column: so an edge is made of the four texels along
// it alone, and neighbours agree on it.
class CubicPatch {
 public:
  CubicPatch(const GeometryImage& image, int i, int j) : z_min_(image.zMin()) {
    for (int b = 0; b < 4; b += 2)
      for (int a = 0; a < 4; a += 2) {
        const Patch<double> quarter = fetchPatch<double>(image, i - 1 + a, j - 1 + b);
        texels_[b][a] = quarter.p00, texels_[b][a + 1] = quarter.p10;
        texels_[b + 1][a] = quarter.p01, texels_[b + 1][a + 1] = quarter.p11;
      }
    const uint32_t chart = chartAt(image, i, j);
    const auto apart = [&](int row, int column) {
      return chartAt(image, i - 1 + column, j - 1 + row) != chart ||
             torn(texels_[row][column] - texels_[row == 3 ? 2 : 1][column == 3 ? 2 : 1]);
    };
    const auto extend = [&](int row, int column, const glm::dvec3& next, const glm::dvec3& second) {
      if (apart(row, column)) texels_[row][column] = 2.0 * next - second;
    };
    for (int k = 1; k <= 2; ++k) {
      extend(k, 0, texels_[k][1], texels_[k][2]), extend(k, 3, texels_[k][2], texels_[k][1]);
      extend(0, k, texels_[1][k], texels_[2][k]), extend(3, k, texels_[2][k], texels_[1][k]);
    }
    for (const int row : {0, 3})
      extend(row, 0, texels_[row][1], texels_[row][2]), extend(row, 3, texels_[row][2], texels_[row][1]);
  }

  glm::dvec3 at(double a, double b) const {
    const Weights wa = weights(a), wb = weights(b);
    glm::dvec3 sum(0);
    for (int row = 0; row < 4; ++row)
      for (int column = 0; column < 4; ++column) sum += wb[row] * wa[column] * texels_[row][column];
    return {sum.x, sum.y, std::clamp(sum.z, z_min_, 0.0)};  // where rays look for it
  }

 private:
  using Weights = std::array<double, 4>;
  static Weights weights(double f) {
    return {((1 - 0.5 * f) * f - 0.5) * f, (1.5 * f - 2.5) * f * f + 1, ((2 - 1.5 * f) * f + 0.5) * f,
            0.5 * (f - 1) * f * f};
  }

  double z_min_;
  glm::dvec3 texels_[4][4];
};

// Pieces per side of a patch.
int piecesOf(const GeometryImage& image, Interpolation between) {
  if (between == Interpolation::kBilinear) return 1;
  LODEN_CHECK_LE(image.side(), kMostCubicSide);
  return image.side() <= kMostCubicSide / 2 ? 4 : 2;
}

}  // namespace

struct GeometryTracer::Impl {
  int cells = 0;  // per side
  double z_min = 0;
  float aspect = 1;
  glm::dvec3 per_length{1};  // tile coordinates to a tile length
  std::vector<Triangle> triangles;
  std::vector<uint32_t> first;  // CSR over cells
  std::vector<CellReference> references;
  std::vector<HeightBounds> bounds;

  Impl(const GeometryImage& image, Interpolation between)
      : cells(std::max(kFewestCells, image.side() / 2)),
        z_min(image.zMin()),
        aspect(image.aspect),
        per_length(periodsPerLength(image.aspect), 1) {
    addTriangles(image, piecesOf(image, between));
    // A surface with large triangles gets larger cells, so that memory stays in proportion.
    while (cells > kFewestCells && countReferences() > 64 * triangles.size()) cells /= 2;
    bin();
  }

  size_t countReferences() const {
    size_t count = 0;
    for (const Triangle& tri : triangles) {
      const CellSpan span = cellSpan(tri);
      count += static_cast<size_t>(span.x1 - span.x0 + 1) * static_cast<size_t>(span.y1 - span.y0 + 1);
    }
    return count;
  }

  void addTriangles(const GeometryImage& image, int pieces) {
    const int n = image.side();
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const Patch<double> patch = fetchPatch<double>(image, i, j);
        if (patch.chart == 0) continue;
        const bool whole =
            !torn(patch.p10 - patch.p00) && !torn(patch.p01 - patch.p00) && !torn(patch.p11 - patch.p00);
        if (pieces > 1 && whole)
          addPieces(CubicPatch(image, i, j), {i, j}, pieces, n);
        else
          addQuad(patch.p00, patch.p10, patch.p01, patch.p11, {i, j}, 1.0, n);
      }
  }

  void addPieces(const CubicPatch& cubic, glm::dvec2 texel, int pieces, int n) {
    const double step = 1.0 / pieces;
    for (int b = 0; b < pieces; ++b)
      for (int a = 0; a < pieces; ++a) {
        const double a0 = a * step, a1 = (a + 1) * step, b0 = b * step, b1 = (b + 1) * step;
        addQuad(cubic.at(a0, b0), cubic.at(a1, b0), cubic.at(a0, b1), cubic.at(a1, b1),
                texel + glm::dvec2(a0, b0), step, n);
      }
  }

  // `texel`: its lower left corner, `step` texels wide.
  void addQuad(const glm::dvec3& p00, const glm::dvec3& p10, const glm::dvec3& p01, const glm::dvec3& p11,
               glm::dvec2 texel, double step, int n) {
    const glm::dvec2 p = (texel + 0.5) / double(n), du(step / n, 0), dv(0, step / n);
    addTriangle({p00, p10 - p00, p11 - p00, p, du, du + dv});
    addTriangle({p00, p11 - p00, p01 - p00, p, du + dv, dv});
  }

  void addTriangle(const Triangle& tri) {
    if (!torn(tri.edge_b) && !torn(tri.edge_c)) triangles.push_back(tri);
  }

  struct CellSpan {
    int x0, x1, y0, y1;
    double z_min, z_max;
  };
  CellSpan cellSpan(const Triangle& tri) const {
    const glm::dvec3 b = tri.a + tri.edge_b, c = tri.a + tri.edge_c;
    const glm::dvec3 lo = glm::min(tri.a, glm::min(b, c)), hi = glm::max(tri.a, glm::max(b, c));
    constexpr double kMargin = 1e-6;
    const auto cell = [&](double at) { return static_cast<int>(std::floor(at * cells)); };
    return {
        cell(lo.x - kMargin), cell(hi.x + kMargin), cell(lo.y - kMargin), cell(hi.y + kMargin), lo.z, hi.z};
  }

  template <class Visit>
  void forEachCell(const Triangle& tri, Visit visit) const {
    const CellSpan span = cellSpan(tri);
    for (int y = span.y0; y <= span.y1; ++y)
      for (int x = span.x0; x <= span.x1; ++x) {
        const int period_x = floorDivide(x), period_y = floorDivide(y);
        const int cell = (y - period_y * cells) * cells + (x - period_x * cells);
        visit(cell, glm::i16vec2(-period_x, -period_y), span.z_min, span.z_max);
      }
  }

  int floorDivide(int index) const { return static_cast<int>(std::floor(double(index) / cells)); }

  void bin() {
    const size_t cell_count = static_cast<size_t>(cells) * cells;
    first.assign(cell_count + 1, 0);
    bounds.assign(cell_count, {});
    for (const Triangle& tri : triangles)
      forEachCell(tri, [&](int cell, glm::i16vec2, double lo, double hi) {
        ++first[cell + 1];
        bounds[cell].add(lo, hi);
      });
    for (size_t c = 0; c < cell_count; ++c) first[c + 1] += first[c];
    references.resize(first.back());
    std::vector<uint32_t> next(first.begin(), first.end() - 1);
    for (uint32_t k = 0; k < triangles.size(); ++k)
      forEachCell(triangles[k], [&](int cell, glm::i16vec2 shift, double lo, double hi) {
        CellReference& reference = references[next[cell]++];
        reference = {k, shift, {}};
        reference.bounds.add(lo, hi);
      });
  }

  // All in tile coordinates. First hit with t in (t_begin, t_end], or any of them if that is enough; marches
  // the cells that the ray crosses (Amanatides and Woo 1987).
  std::optional<CellHit> march(const glm::dvec3& o, const glm::dvec3& d, double t_begin, double t_end,
                               bool any) const {
    const double infinity = std::numeric_limits<double>::infinity();
    const glm::dvec2 start = (glm::dvec2(o) + glm::dvec2(d) * t_begin) * double(cells);
    glm::ivec2 cell(static_cast<int>(std::floor(start.x)), static_cast<int>(std::floor(start.y)));
    glm::ivec2 step;
    glm::dvec2 next, delta;
    for (int axis = 0; axis < 2; ++axis) {
      const double speed = d[axis] * cells;
      step[axis] = speed > 0 ? 1 : -1;
      delta[axis] = speed != 0 ? std::abs(1 / speed) : infinity;
      const double border = cell[axis] + (speed > 0 ? 1 : 0);
      next[axis] = speed != 0 ? (border - o[axis] * cells) / speed : infinity;
    }
    for (double t = t_begin; t <= t_end;) {
      const double t_exit = std::min({next.x, next.y, t_end});
      if (auto hit = searchCell(cell, o, d, t_begin, t, t_exit, any)) return hit;
      if (t_exit >= t_end) break;
      const int axis = next.x <= next.y ? 0 : 1;
      t = next[axis];
      next[axis] += delta[axis];
      cell[axis] += step[axis];
    }
    return std::nullopt;
  }

  std::optional<CellHit> searchCell(glm::ivec2 cell, const glm::dvec3& o, const glm::dvec3& d, double t_begin,
                                    double t_enter, double t_exit, bool any) const {
    constexpr double kOverlap = 1e-7;
    const glm::ivec2 period(floorDivide(cell.x), floorDivide(cell.y));
    const size_t base = static_cast<size_t>(cell.y - period.y * cells) * cells + (cell.x - period.x * cells);
    const double z0 = o.z + d.z * t_enter, z1 = o.z + d.z * t_exit;
    const double lo = std::min(z0, z1), hi = std::max(z0, z1);
    if (!bounds[base].meets(lo, hi)) return std::nullopt;
    CellHit best{{t_exit + kOverlap, 0, 0}, nullptr, glm::dvec2(0)};
    for (uint32_t r = first[base]; r < first[base + 1]; ++r) {
      const CellReference& reference = references[r];
      if (!reference.bounds.meets(lo, hi)) continue;
      const glm::dvec2 offset = glm::dvec2(period) + glm::dvec2(reference.shift);
      const auto hit = intersect(triangles[reference.triangle], o - glm::dvec3(offset, 0), d);
      if (!hit || hit->t <= t_begin || hit->t > best.at.t) continue;
      best = {*hit, &triangles[reference.triangle], offset};
      if (any) break;
    }
    if (!best.triangle) return std::nullopt;
    return best;
  }

  std::optional<TraceHit> firstHit(const glm::dvec3& o, const glm::dvec3& d, double t_begin,
                                   double t_end) const {
    const auto found = march(o, d, t_begin, t_end, false);
    if (!found) return std::nullopt;
    const Triangle& triangle = *found->triangle;
    TraceHit hit;
    hit.p = triangle.p + found->at.u * triangle.p_b + found->at.v * triangle.p_c + found->shift;
    hit.position = o + found->at.t * d;
    const glm::dvec3 across = glm::cross(triangle.edge_b, triangle.edge_c);
    hit.normal = glm::normalize(per_length * (glm::dot(across, d) > 0 ? -across : across));
    return hit;
  }
};

GeometryTracer::GeometryTracer(const GeometryImage& image, Interpolation between)
    : impl_(std::make_unique<Impl>(image, between)) {}
GeometryTracer::~GeometryTracer() = default;
GeometryTracer::GeometryTracer(GeometryTracer&&) noexcept = default;
GeometryTracer& GeometryTracer::operator=(GeometryTracer&&) noexcept = default;

std::optional<TraceHit> GeometryTracer::traceView(glm::dvec2 x, const glm::dvec3& wo) const {
  LODEN_CHECK_LT(0.0, wo.z);
  const double end = (-impl_->z_min + 1e-6) / wo.z;
  const glm::dvec2 period = glm::floor(x);  // far away a cell has no number, and a double few digits
  auto hit = impl_->firstHit({x - period, 0}, -wo * impl_->per_length, -1e-6 / wo.z, end);
  if (hit) hit->p += period, hit->position += glm::dvec3(period, 0);
  return hit;
}

bool GeometryTracer::occluded(const glm::dvec3& origin, const glm::dvec3& direction) const {
  LODEN_CHECK_LT(0.0, direction.z);
  const glm::dvec3 start(glm::dvec2(origin) - glm::floor(glm::dvec2(origin)), origin.z);
  return impl_->march(start, direction * impl_->per_length, 1e-9, (1e-6 - origin.z) / direction.z, true)
      .has_value();
}

std::optional<TraceHit> GeometryTracer::trace(const glm::dvec3& origin, const glm::dvec3& direction) const {
  const glm::dvec2 period = glm::floor(glm::dvec2(origin));
  const glm::dvec3 start = origin - glm::dvec3(period, 0);
  const double rise = direction.z > 0 ? 1e-6 - origin.z : origin.z - impl_->z_min + 1e-6;
  const double end = std::min(kReach, rise / std::max(std::abs(direction.z), 1e-12));
  auto hit = impl_->firstHit(start, direction * impl_->per_length, 1e-9, end);
  if (hit) hit->p += period, hit->position += glm::dvec3(period, 0);
  return hit;
}

float GeometryTracer::aspect() const {
  return impl_->aspect;
}

}  // namespace loden
