// Integrals over directions, for tests.
#pragma once

#include <cmath>

#include "material/model/directions.h"

namespace loden::test {

// The integral of visit(w) dw / pi over the hemisphere, by the midpoint rule on `rows` rows of equal solid
// angle.
template <class Visit>
auto hemisphereIntegral(const Visit& visit, int rows = 200) {
  auto sum = 0.0 * visit(glm::dvec3(0, 0, 1));
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < 2 * rows; ++column)
      sum += visit(directionFromSpherical({std::acos((row + 0.5) / rows), kPi * (column + 0.5) / rows})) /
             double(rows * rows);
  return sum;
}

}  // namespace loden::test
