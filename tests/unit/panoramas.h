// Makes panoramas from formulas.
#pragma once

#include "material/model/environment.h"

namespace loden::test {

// A panorama of 2 height x height pixels; `radiance` is a function of the direction that returns a vec3.
Panorama panoramaOf(int height, const auto& radiance) {
  Panorama panorama{2 * height, height, {}};
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < 2 * height; ++column)
      panorama.pixels.push_back(radiance(panoramaDirection(panorama, column + 0.5, row + 0.5)));
  return panorama;
}

}  // namespace loden::test
