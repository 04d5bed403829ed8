// One term of the equation: w_b(lambda) * dot(D_b(q_b), E_b(wi, wo)).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "material/model/directions.h"
#include "material/model/texture.h"

namespace loden {

enum class Domain : uint32_t { kReference = 0, kFlat = 1 };
enum class WeightFilter : uint32_t {
  kNearest = 0,  // as published (LBTF 3.1: nearest-neighbour up-sampling)
  kLinear = 1,   // bilinear, and trilinear between mips
};
enum class TableLayout : uint32_t {
  kNearest = 0,  // volume of lights x views x quads, read at the nearest sampled pair
  kGrid =
      1,  // volume (phi_i, theta_o * thetas + theta_i, quad * phis + phi_o), read by two trilinear fetches
};

// 0 at and below in_begin, 1 from in_end to out_begin, 0 at and above out_end; linear between. Units of
// lambda; in_begin < in_end and out_begin < out_end. The default is 1 at every lambda >= 0.
struct Window {
  float in_begin = -2, in_end = -1, out_begin = 1e4f, out_end = 2e4f;
};
template <class T>
T windowWeight(const Window& window, T lambda);

// A lat-long grid of directions: thetas rows from the pole to theta_max, phis columns of which the last
// repeats the first. Light or view beyond theta_max reads the last row. theta_max is the material's; each
// band's table has rows and columns of its own.
struct DirectionGrid {
  int thetas = 6;
  int phis = 25;
  float theta_max = static_cast<float>(75.0 * kPi / 180.0);  // radians
};

// The levels at which a quad adds to its band: nothing up to begin, all of itself one level later, all up to
// one level before end, and nothing from there on.
inline constexpr float kNoEnd = 1e4f;  // beyond every lambda that there is
struct QuadLevels {
  float begin = -kNoEnd, end = kNoEnd;
  bool operator==(const QuadLevels&) const = default;
};

// Components travel in quads of four. Quads 0 .. y_quads-1 hold four Y components each; then chroma_quads,
// each with two Cb components in xy and two Cr components in zw; then, if ratio, one layer of weights only
// whose rg are Cb/Y and Cr/Y of the whole value: the band then adds ratio * (Y_b + mu.Y) - mu.C to C.
struct Band {
  Domain domain = Domain::kReference;
  WeightFilter filter = WeightFilter::kLinear;
  TableLayout layout = TableLayout::kGrid;
  Window window;
  float lambda_first = 0;  // lambda of the weights' mip 0
  int y_quads = 0;
  int chroma_quads = 0;
  bool ratio = false;
  // The first of y_quads, which with the ratio layer are stored apart from the rest and can be shown without
  // it (material/model/leading_part.h); 0: stored in one.
  int lead_quads = 0;
  // Per quad of y and chroma: products D*E are multiplied by this (folds both 8-bit scales).
  std::vector<glm::vec4> quad_scale;
  // Per quad of y and chroma. None begins before the quad before it, or ends after that; the first quad's are
  // not read, it adds all at every lambda.
  std::vector<QuadLevels> quad_levels;
  glm::vec4 ratio_scale{1};
  Texture weights;  // 2-D array, layers = layers() (+ spare layers, zero)
  Texture table;    // volume
  int quads() const { return y_quads + chroma_quads; }
  int layers() const { return quads() + (ratio ? 1 : 0); }
  size_t bytes() const { return weights.data.size() + table.data.size(); }
};

// Share of itself that the quad adds at that lambda.
template <class T>
T quadShare(const Band& band, int quad, T lambda);

// Grid of a kGrid table: its width is phis, its height thetas squared.
DirectionGrid tableGrid(const Band& band, float theta_max);

}  // namespace loden
