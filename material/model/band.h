// A band, one fitted term of the material's equation (material/model/material.h): w_b(lambda) * dot(D_b(q_b),
// E_b(wi, wo)). The weights D_b are a texture, the eigen BRDFs E_b a table over pairs of directions, and w_b
// is a window over the level of detail.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "material/model/directions.h"
#include "material/model/texture.h"

namespace loden {

// What the weights are indexed by: x on the reference plane (kReference), or p on the tile's own surface
// (kFlat).
enum class Domain : uint32_t { kReference = 0, kFlat = 1 };
enum class WeightFilter : uint32_t {
  kNearest = 0,  // as published (LBTF 3.1: nearest-neighbour up-sampling)
  kLinear = 1,   // bilinear, and trilinear between mips
};
enum class TableLayout : uint32_t {
  kNearest = 0,  // volume of lights x views x quads, read at the nearest sampled pair of directions
  // Volume (phi_i, theta_o * thetas + theta_i, quad * phis + phi_o), read by two trilinear fetches.
  kGrid = 1,
};

// A window over lambda: 0 at and below in_begin, 1 from in_end to out_begin, 0 at and above out_end, and
// linear in between. in_begin < in_end and out_begin < out_end. The default is 1 at every lambda >= 0.
struct Window {
  float in_begin = -2, in_end = -1, out_begin = 1e4f, out_end = 2e4f;
};
template <class T>
T windowWeight(const Window& window, T lambda);

// A lat-long grid of directions: `thetas` rows from the pole to theta_max, and `phis` columns of which the
// last repeats the first. A light or view direction beyond theta_max reads the last row. theta_max is the
// material's; the numbers of rows and columns are each band's own.
struct DirectionGrid {
  int thetas = 6;
  int phis = 25;
  float theta_max = static_cast<float>(75.0 * kPi / 180.0);  // radians
};

// The levels of detail at which a quad adds to its band: nothing up to `begin`, its full value one level
// later, its full value up to one level before `end`, and nothing from `end` on.
inline constexpr float kNoEnd = 1e4f;  // beyond every lambda that there is
struct QuadLevels {
  float begin = -kNoEnd, end = kNoEnd;
  bool operator==(const QuadLevels&) const = default;
};

// The data of a band. The components of the dot product are grouped in quads of four. Quads 0 .. y_quads-1
// hold four Y (luma) components each. The next chroma_quads quads hold two Cb components in xy and two Cr
// components in zw each. If `ratio` is set, the weights have one more layer, whose rg are Cb/Y and Cr/Y of
// the whole value: the band then adds ratio * (Y_b + mu.Y) - mu.C to the chroma C.
struct Band {
  Domain domain = Domain::kReference;
  WeightFilter filter = WeightFilter::kLinear;
  TableLayout layout = TableLayout::kGrid;
  Window window;
  float lambda_first = 0;  // lambda of mip 0 of the weights
  int y_quads = 0;
  int chroma_quads = 0;
  bool ratio = false;
  // How many of the first y_quads are, together with the ratio layer, stored apart from the rest, so that
  // they can be shown without it (material/model/leading_part.h); 0: the band is stored in one piece.
  int lead_quads = 0;
  // Per Y and chroma quad: the factor of the products D*E, which combines the scales of both 8-bit formats.
  std::vector<glm::vec4> quad_scale;
  // Per Y and chroma quad: its levels. No quad begins before the one before it, or ends after it. The first
  // quad's entry is not read, since that quad adds its full value at every lambda.
  std::vector<QuadLevels> quad_levels;
  glm::vec4 ratio_scale{1};
  Texture weights;  // 2-D array of layers() layers, perhaps followed by spare layers, which are zero
  Texture table;    // volume; see TableLayout
  int quads() const { return y_quads + chroma_quads; }
  int layers() const { return quads() + (ratio ? 1 : 0); }
  size_t bytes() const { return weights.data.size() + table.data.size(); }
};

// The share, 0 to 1, of its full value that a quad adds at this lambda.
template <class T>
T quadShare(const Band& band, int quad, T lambda);

// The direction grid of a kGrid table: the table's width is phis, its height thetas squared.
DirectionGrid tableGrid(const Band& band, float theta_max);

}  // namespace loden
