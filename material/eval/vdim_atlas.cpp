// Building the atlas from the geometry image, and the direction grid that it is sampled on.

#include <algorithm>
#include <array>
#include <cmath>

#include "material/base/check.h"
#include "material/base/issues.h"
#include "material/model/vdim.h"

namespace loden {
namespace {

// The depth has no divisor in common with 255: no depth of the atlas lies on the border of two slices, where
// rounding would decide.
constexpr int kVolumeSide = 38, kVolumeDepth = 11;

// Neighbouring texels so many periods apart in x or y are a tear in a damaged image, not surface.
constexpr double kTear = 0.5;

// atanh(sin(kThetaMax)): the radius of the rim before scaling to 1.
double rimRadius() {
  static const double kRim = std::atanh(std::sin(kThetaMax));
  return kRim;
}

// The patches of a geometry image, seen from one direction after the other.
//
// Seen along the view ray with slope s = wo.xy / wo.z, the point P lies at P.xy - s P.z on the reference
// plane, and the first hit of the ray through x is the highest point that lies at x: a depth buffer. Most
// patches are smaller than what is between two samples, and cover none.
class ShearedPatches {
 public:
  explicit ShearedPatches(const GeometryImage& image) {
    for (int j = 0; j < image.side(); ++j)
      for (int i = 0; i < image.side(); ++i) {
        const Patch<double> patch = fetchPatch<double>(image, i, j);
        if (patch.chart != 0) add({patch.p00, patch.p10, patch.p11, patch.p01});
      }
    // Whole blocks, so that the loops over them have a constant length, which the compiler vectorizes.
    while (count() % kBlock != 0) add({});
  }

  // Highest z at the side^2 texel centres, and `lowest` where nothing is.
  void highest(const glm::dvec2& slope, int side, double lowest, std::vector<double>& z) const {
    z.assign(size_t(side) * size_t(side), lowest);
    Spans columns, rows;
    for (size_t begin = 0; begin < count(); begin += kBlock) {
      findSpans(corners_[0], begin, float(slope.x), float(side), columns);
      findSpans(corners_[1], begin, float(slope.y), float(side), rows);
      std::array<uint8_t, kBlock> covers;
      for (size_t k = 0; k < kBlock; ++k)
        covers[k] = (columns.begin[k] < columns.end[k]) & (rows.begin[k] < rows.end[k]);
      for (size_t k = 0; k < kBlock; ++k) {
        if (!covers[k]) continue;
        const Samples samples{
            {columns.begin[k], rows.begin[k]}, {columns.end[k], rows.end[k]}, side, 1.0 / side};
        if (samples.end.x - samples.begin.x > kNarrow) [[unlikely]] {
          drawWide(begin + k, slope, samples, z);
          continue;
        }
        const std::array<glm::dvec3, 4> p = sheared(begin + k, slope);
        drawTriangle(p[0], p[1], p[2], samples, z);
        drawTriangle(p[0], p[2], p[3], samples, z);
      }
    }
  }

 private:
  static constexpr size_t kBlock = 64;
  using Corners = std::array<std::vector<float>, 4>;  // around the patch
  static constexpr double kSeam = 1e-9;               // closes the seams between neighbours
  static constexpr int kNarrow = 8;                   // samples that are tested sooner than left out
  static constexpr double kFar = 1e6;                 // samples; farther than any triangle
  struct Spans {
    std::array<int, kBlock> begin, end;  // of samples
  };
  struct Samples {
    glm::ivec2 begin, end;
    int side;
    double spacing;  // 1 / side
  };

  size_t count() const { return corners_[0][0].size(); }

  void add(const std::array<glm::dvec3, 4>& corners) {
    for (const glm::dvec3& corner : corners) {
      const glm::dvec2 edge = glm::abs(glm::dvec2(corner - corners[0]));
      if (std::max(edge.x, edge.y) >= kTear) return;
    }
    for (int axis = 0; axis < 3; ++axis)
      for (size_t c = 0; c < 4; ++c) corners_[size_t(axis)][c].push_back(float(corners[c][axis]));
  }

  // Of the samples (i + .5) / n between the least and the largest place of four corners along one axis;
  // rather one too many than one too few.
  void findSpans(const Corners& at, size_t begin, float slope, float n, Spans& spans) const {
    // Samples. The conversion rounds towards 0, so all is moved above it: no patch lies further out than the
    // deepest tile's under the flattest view.
    constexpr float kMargin = 2e-3f, kPositive = 8192;
    const float *a = &at[0][begin], *b = &at[1][begin], *c = &at[2][begin], *d = &at[3][begin];
    const Corners& z = corners_[2];
    const float *az = &z[0][begin], *bz = &z[1][begin], *cz = &z[2][begin], *dz = &z[3][begin];
    for (size_t k = 0; k < kBlock; ++k) {
      const float pa = a[k] - slope * az[k], pb = b[k] - slope * bz[k], pc = c[k] - slope * cz[k],
                  pd = d[k] - slope * dz[k];
      const float low = std::min(std::min(pa, pb), std::min(pc, pd)),
                  high = std::max(std::max(pa, pb), std::max(pc, pd));
      spans.begin[k] = static_cast<int>(low * n + (kPositive + 0.5f - kMargin)) - static_cast<int>(kPositive);
      spans.end[k] = static_cast<int>(high * n + (kPositive + 0.5f + kMargin)) - static_cast<int>(kPositive);
    }
  }

  std::array<glm::dvec3, 4> sheared(size_t patch, const glm::dvec2& slope) const {
    std::array<glm::dvec3, 4> p;
    for (size_t c = 0; c < 4; ++c) {
      const double z = corners_[2][c][patch];
      p[c] = {corners_[0][c][patch] - slope.x * z, corners_[1][c][patch] - slope.y * z, z};
    }
    return p;
  }

  static void drawTriangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
                           const Samples& samples, std::vector<double>& z) {
    const glm::dvec3 ab = b - a, ac = c - a;
    const double det = ab.x * ac.y - ab.y * ac.x;
    if (std::abs(det) < 1e-18) return;
    // Barycentric coordinates of b and c, linear in the sample's place.
    const glm::dvec2 du = glm::dvec2(ac.y, -ac.x) / det, dv = glm::dvec2(-ab.y, ab.x) / det;
    for (int j = samples.begin.y; j < samples.end.y; ++j)
      for (int i = samples.begin.x; i < samples.end.x; ++i) {
        const glm::dvec2 d = (glm::dvec2(i, j) + 0.5) * samples.spacing - glm::dvec2(a);
        const double u = glm::dot(du, d), v = glm::dot(dv, d);
        if (std::min(std::min(u, v), 1 - u - v) < -kSeam) continue;
        double& highest = z[size_t(wrap(j, samples.side) * samples.side + wrap(i, samples.side))];
        highest = std::max(highest, a.z + u * ab.z + v * ac.z);
      }
  }

  [[gnu::noinline]] void drawWide(size_t patch, const glm::dvec2& slope, const Samples& samples,
                                  std::vector<double>& z) const {
    const std::array<glm::dvec3, 4> p = sheared(patch, slope);
    drawSliver(p[0], p[1], p[2], samples, z);
    drawSliver(p[0], p[2], p[3], samples, z);
  }

  // As drawTriangle row by row, of each no more than the triangle can cover and a sample at either end: a
  // steep triangle seen from the side is a sliver across many periods, and the box around it nearly empty.
  static void drawSliver(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
                         const Samples& samples, std::vector<double>& z) {
    const glm::dvec2 ab = b - a, ac = c - a;
    const double det = ab.x * ac.y - ab.y * ac.x;
    const glm::dvec2 edges[3] = {{ac.y, -ac.x}, {-ab.y, ab.x}, {ab.y - ac.y, ac.x - ab.x}};
    // Where the edges cross row j, in samples: at + change * j.
    struct Crossing {
      double at, change;
    };
    std::array<Crossing, 2> left, right;
    left.fill({double(samples.begin.x), 0});
    right.fill({double(samples.end.x), 0});
    size_t lefts = 0, rights = 0;
    for (int e = 0; e < 3; ++e) {
      constexpr double kFlat = 1e-6;  // such an edge crosses rows nowhere in particular
      if (std::abs(edges[e].x) <= kFlat * std::abs(edges[e].y)) continue;
      const glm::dvec2 from = glm::dvec2(e == 2 ? b : a) / samples.spacing - 0.5;
      const double change = -edges[e].y / edges[e].x;
      const Crossing crossing{from.x - change * from.y, change};
      if (edges[e].x * det > 0)
        left[lefts++] = crossing;
      else
        right[rights++] = crossing;
    }
    for (int j = samples.begin.y; j < samples.end.y; ++j) {
      const auto crosses = [j](const Crossing& crossing) { return crossing.at + crossing.change * j; };
      const double begin = std::max(crosses(left[0]), crosses(left[1])) - 1,
                   end = std::min(crosses(right[0]), crosses(right[1])) + 2;
      Samples row = samples;
      row.begin = {std::max(row.begin.x, static_cast<int>(std::max(begin, -kFar))), j};
      row.end = {std::min(row.end.x, static_cast<int>(std::min(end, kFar))), j + 1};
      if (row.begin.x < row.end.x) drawTriangle(a, b, c, row, z);
    }
  }
  static int wrap(int i, int n) { return (i % n + n) % n; }

  std::array<Corners, 3> corners_;  // x, y, z
};

void drawLayer(const ShearedPatches& patches, const VdimAtlasSize& size, double z_min, int layer,
               Texture& depth) {
  const glm::dvec2 square((layer % size.directions + 0.5) / size.directions,
                          (layer / size.directions + 0.5) / size.directions);
  const glm::dvec3 wo = vdimViewFromSquare(square);
  std::vector<double> z;
  patches.highest(glm::dvec2(wo) / wo.z, size.texels, z_min, z);
  auto* codes = reinterpret_cast<uint8_t*>(depth.data.data()) + size_t(layer) * z.size();
  for (size_t k = 0; k < z.size(); ++k)
    codes[k] = static_cast<uint8_t>(std::lround(255 * std::clamp(1 - z[k] / z_min, 0.0, 1.0)));
}

// Columns of the volume over one period, by a cell's indices of any period, and by a place.
int columnCell(double at) {
  return static_cast<int>(std::floor(at * kVolumeSide));
}
size_t column(int x, int y) {
  return size_t(wrapIndex(y, kVolumeSide)) * kVolumeSide + size_t(wrapIndex(x, kVolumeSide));
}
size_t columnAt(const glm::dvec3& place) {
  return column(columnCell(place.x), columnCell(place.y));
}

// Surface points in columns over one period, to find the one nearest to a place.
class PointColumns {
 public:
  // Without undersides, which views from above hardly meet first; of all patches, if nothing else is there.
  explicit PointColumns(const GeometryImage& image) : columns_(size_t(kVolumeSide) * kVolumeSide) {
    add(image, kUnderside);
    if (empty_) add(image, -1);
  }
  bool empty() const { return empty_; }

  // p - X.xy of the nearest point, into [-.5, .5]. Rings of columns around the place, until the next is
  // farther away than what was found.
  glm::dvec2 nearestDisplacement(const glm::dvec3& place) const {
    Nearest best;
    for (int ring = 0; ring <= kVolumeSide / 2; ++ring) {
      const double beyond = std::max(ring - 1, 0) / double(kVolumeSide);
      if (best.point && beyond * beyond > best.distance) break;
      for (int y = -ring; y <= ring; ++y) {
        const int step = std::abs(y) == ring ? 1 : std::max(2 * ring, 1);  // the ring's border alone
        for (int x = -ring; x <= ring; x += step)
          search(columnCell(place.x) + x, columnCell(place.y) + y, place, best);
      }
    }
    const glm::dvec2 displacement = best.point->p - glm::dvec2(best.point->position);
    return displacement - glm::dvec2(std::nearbyint(displacement.x), std::nearbyint(displacement.y));
  }

 private:
  struct Point {
    glm::dvec3 position;
    glm::dvec2 p;
  };
  struct Nearest {
    const Point* point = nullptr;
    double distance = 1e30;  // squared
  };

  // The cosine of normal and z from which on a patch is an underside. Steeper ones are seen at grazing views.
  static constexpr double kUnderside = -0.5;

  // The patches with at least that cosine.
  void add(const GeometryImage& image, double least) {
    const int n = image.side();
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const Patch<double> patch = fetchPatch<double>(image, i, j);
        const glm::dvec3 normal = glm::cross(patch.p11 - patch.p00, patch.p01 - patch.p10);
        if (patch.chart == 0 || normal.z < least * glm::length(normal)) continue;
        const glm::dvec3 at = 0.25 * (patch.p00 + patch.p10 + patch.p01 + patch.p11);
        columns_[columnAt(at)].push_back({at, glm::dvec2((i + 1.0) / n, (j + 1.0) / n)});
        empty_ = false;
      }
  }

  // Of points at one distance the lower p wins, so that the order of the search does not matter.
  void search(int x, int y, const glm::dvec3& place, Nearest& best) const {
    for (const Point& point : columns_[column(x, y)]) {
      glm::dvec3 d = point.position - place;
      d.x -= std::nearbyint(d.x);
      d.y -= std::nearbyint(d.y);
      const double distance = glm::dot(d, d);
      const bool first = !best.point || point.p.y < best.point->p.y ||
                         (point.p.y == best.point->p.y && point.p.x < best.point->p.x);
      if (distance < best.distance || (distance == best.distance && first)) best = {&point, distance};
    }
  }

  std::vector<std::vector<Point>> columns_;
  bool empty_ = true;
};

Texture buildVolume(const GeometryImage& image, const ForEach& for_each) {
  Texture volume =
      Texture::make(TexelFormat::kRG8Unorm, TextureShape::kVolume, kVolumeSide, kVolumeSide, kVolumeDepth);
  const PointColumns points(image);
  if (points.empty()) return volume;
  for_each(kVolumeDepth * kVolumeSide, [&](int row) {
    const int y = row % kVolumeSide, z = row / kVolumeSide;
    for (int x = 0; x < kVolumeSide; ++x) {
      const glm::dvec3 centre((x + 0.5) / kVolumeSide, (y + 0.5) / kVolumeSide,
                              (z + 0.5) / kVolumeDepth * image.zMin());
      storeTexel(volume, 0, x, y, z,
                 glm::vec4(glm::vec2(points.nearestDisplacement(centre)) + 128.0f / 255.0f, 0, 0));
    }
  });
  return volume;
}

}  // namespace

// Per view a patch is two slivers: so many rows of samples high as its edges and its height, seen at the
// slope, are long, and so many samples wide as its edges. `kSlope` is the mean of the grid's views along an
// axis, rounded up; a row costs kRow times what a patch does that covers no sample.
Status checkVdimWork(const GeometryImage& image, VdimAtlasSize size) {
  constexpr double kSlope = 4, kRow = 8;
  const int n = image.side();
  double work = 0;
  std::array<uint32_t, size_t{kVolumeSide} * kVolumeSide> columns{};
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const Patch<double> patch = fetchPatch<double>(image, i, j);
      if (patch.chart == 0) continue;
      const auto apart = [&](const glm::dvec3& corner) { return glm::abs(corner - patch.p00); };
      const glm::dvec3 most = glm::max(apart(patch.p10), glm::max(apart(patch.p01), apart(patch.p11)));
      const double across = std::max(most.x, most.y);
      if (across < kTear)
        work += (kRow * size.texels * (across + kSlope * most.z) + 1) * (size.texels * across + 1);
      ++columns[columnAt(0.25 * (patch.p00 + patch.p10 + patch.p01 + patch.p11))];
    }
  work *= double(size.directions) * size.directions;
  const auto issue = [](int id, const char* text) {
    return Issue{id, Severity::kError, "geometry image", text};
  };
  if (work > double(kMaxVdimWork))
    return issue(
        issue_id::kAtlasWork,
        "its surface is torn in so many places that an atlas of this size would take minutes to build");
  if (!image.identity_parameterization && *std::max_element(columns.begin(), columns.end()) > kMaxVdimColumn)
    return issue(issue_id::kAtlasColumn, "nearly all of its surface is in one place");
  return {};
}

uint64_t vdimDepthBytes(VdimAtlasSize size) {
  const auto square = [](int side) { return uint64_t(side) * uint64_t(side); };
  return textureBytes(TexelFormat::kR8Unorm, square(size.texels), 1, square(size.directions), 1);
}

uint64_t vdimAtlasBytes(const GeometryImage& image, VdimAtlasSize size) {
  const auto side = uint64_t(image.side());
  const bool heights = image.identity_parameterization;
  const TexelFormat format = heights ? TexelFormat::kRG8Unorm : TexelFormat::kRGBA8Unorm;
  const uint64_t maps = vdimDepthBytes(size) + textureBytes(format, side * side, 1, 1, 1);
  return heights ? maps
                 : maps + textureBytes(TexelFormat::kRG8Unorm, kVolumeSide, kVolumeSide, kVolumeDepth, 1);
}

uint64_t residentAtlasBytes(const GeometryImage& image, VdimAtlasSize size) {
  const uint64_t first = vdimDepthBytes(kFirstVdimAtlas);
  return vdimAtlasBytes(image, size) + (vdimDepthBytes(size) > first ? first : 0);
}

glm::dvec3 vdimViewFromSquare(glm::dvec2 square) {
  const glm::dvec2 disk = diskFromSquare(square);
  const double radius = glm::length(disk);
  if (radius < 1e-12) return {0, 0, 1};
  const double sine = std::tanh(std::min(radius, 1.0) * rimRadius());
  return {disk * (sine / radius), std::sqrt(1 - sine * sine)};
}

Texture buildVdimDepth(const GeometryImage& image, VdimAtlasSize size, const ForEach& for_each) {
  LODEN_CHECK_LT(0, size.texels);
  LODEN_CHECK_LT(0, size.directions);
  const int layers = size.directions * size.directions;
  Texture depth =
      Texture::make(TexelFormat::kR8Unorm, TextureShape::kArray2D, size.texels, size.texels, layers);
  const ShearedPatches patches(image);
  const double z_min = -packedRange(image).z;
  for_each(layers, [&](int layer) { drawLayer(patches, size, z_min, layer, depth); });
  return depth;
}

VdimAtlas buildVdimAtlas(const GeometryImage& image, VdimAtlasSize size, const ForEach& for_each) {
  VdimAtlas atlas;
  atlas.size = size;
  atlas.geometry = packGeometry(image);
  atlas.depth = buildVdimDepth(image, size, for_each);
  if (!image.identity_parameterization) atlas.volume = buildVolume(image, for_each);
  return atlas;
}

}  // namespace loden
