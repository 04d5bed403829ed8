// Texels that are fitted to the filter that reads them. Not installed.
//
// A texel that holds the mean of its surface is blurred once more by the linear filter. Here the whole map is
// chosen so that the filtered map is closest, in the least squares sense, to all samples of the surface that
// a view sees. Dark samples count more than bright ones, because the eye sees an error there sooner.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace loden::importer {

class LinearTexels {
 public:
  // A periodic side x side map with per_side^2 samples a texel, or fewer; `lights` maps in one.
  LinearTexels(int side, int per_side, size_t lights);

  // A sample at `place` in a texel, in [0,1]^2, its value under every light. Touches the texel's neighbours:
  // at the same time only for rows that are three or more apart.
  void add(glm::ivec2 texel, const glm::dvec2& place, std::span<const glm::vec3> values);

  // The map of one light. texels: [texel] means, holes filled: the first guess, and what texels with few
  // samples around them stay close to; replaced by the fitted ones, none below 0.
  void fit(size_t light, std::span<glm::vec3> texels) const;

 private:
  static constexpr int kNear = 9;  // a texel and its neighbours, row by row
  size_t texelAt(glm::ivec2 at) const;
  using Row = std::array<float, kNear>;  // of the normal equations

  int side_;
  size_t lights_;
  float full_;                    // samples a texel
  std::vector<Row> normal_;       // [texel][light]
  std::vector<glm::vec3> right_;  // [texel][light]
};

}  // namespace loden::importer
