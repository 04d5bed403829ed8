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

// Components travel in quads of four. Quads 0 .. y_quads-1 hold four Y components each; then chroma_quads,
// each with two Cb components in xy and two Cr components in zw; then, if ratio, one layer of weights only
// whose rg are Cb/Y and Cr/Y of the whole value: the band then adds ratio * (Y_b + mu.Y) - mu.C to C; then
// light_quads layers of weights for the light factor V = clamp(dot(D, E(wi)), 0, 1), the share of the light
// wi that reaches the point (FBTF section 5: shadows apart from shading), with a table of its own that knows
// the light alone. A band that has one adds V * (mu + B) - mu in place of B. Behind these layers it has one
// more, the ambient one: four components that change over p as what light from all around makes of the band
// does (environmentTable).
struct Band {
  Domain domain = Domain::kReference;
  WeightFilter filter = WeightFilter::kLinear;
  TableLayout layout = TableLayout::kGrid;
  Window window;
  float lambda_first = 0;  // lambda of the weights' mip 0
  int y_quads = 0;
  int chroma_quads = 0;
  bool ratio = false;
  int light_quads = 0;
  // The first of y_quads, which with the ratio layer are stored apart from the rest and can be shown without
  // it (material/model/leading_part.h); 0: stored in one, as bands with light quads are.
  int lead_quads = 0;
  // Per quad of y, chroma and light: products D*E are multiplied by this (folds both 8-bit scales).
  std::vector<glm::vec4> quad_scale;
  glm::vec4 ratio_scale{1};
  Texture weights;      // 2-D array, layers = layers() (+ spare layers, zero)
  Texture table;        // volume
  Texture light_table;  // volume (phi_i, theta_i, light quad), a grid of its own; empty without light quads
  int quads() const { return y_quads + chroma_quads; }
  int lightLayer() const { return quads() + (ratio ? 1 : 0); }  // the first of the light factor
  int ambientLayer() const { return lightLayer() + light_quads; }
  int layers() const { return ambientLayer() + (light_quads > 0 ? 1 : 0); }
  size_t bytes() const { return weights.data.size() + table.data.size() + light_table.data.size(); }
};

// Grid of a kGrid table: its width is phis, its height thetas squared.
DirectionGrid tableGrid(const Band& band, float theta_max);
// Grid of the light factor's table.
DirectionGrid lightTableGrid(const Band& band, float theta_max);

}  // namespace loden
