// Fits the texels of a map to the linear filter that reads it. Not installed.
//
// If a texel holds the mean of its surface, the linear filter blurs it once more. Here the whole map is
// chosen so that the filtered map is closest, in the least-squares sense, to all samples of the surface that
// a view sees. Dark samples have more weight than bright ones, because errors are more visible there.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace loden::importer {

class LinearTexels {
 public:
  // Fits periodic side x side maps with at most per_side^2 samples per texel, `lights` maps at once.
  LinearTexels(int side, int per_side, size_t lights);

  // Adds a sample at `place` in a texel, in [0,1]^2, with its value under every light. This changes data of
  // the neighbouring texels too, so that concurrent calls are allowed only for rows that are three or more
  // apart.
  void add(glm::ivec2 texel, const glm::dvec2& place, std::span<const glm::vec3> values);

  // Fits the map of one light. `texels`: on input the mean of each texel, with holes filled, which is the
  // first guess and what texels with few samples around them stay close to; on output the fitted texels, none
  // below 0.
  void fit(size_t light, std::span<glm::vec3> texels) const;

 private:
  static constexpr int kNear = 9;  // a texel and its eight neighbours, row by row
  size_t texelAt(glm::ivec2 at) const;
  using Row = std::array<float, kNear>;  // a row of the normal equations

  int side_;
  size_t lights_;
  float full_;                    // samples per full texel
  std::vector<Row> normal_;       // [texel][light]
  std::vector<glm::vec3> right_;  // [texel][light]
};

}  // namespace loden::importer
