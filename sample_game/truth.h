// A picture that somebody ray traced from the walk's first camera, to compare with.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <vector>

#include "material/base/result.h"
#include "material/model/analytic_surface.h"

namespace loden::walk {

struct Truth {
  Camera camera;
  glm::ivec2 size{0};
  std::vector<glm::u8vec4> codes;  // sRGB, [height][width], first row at the top
};
// Issues of openFileSource and decodeImage; kOption if its proportions are not those of a window of that
// size, to a pixel.
Result<Truth> readTruth(const std::filesystem::path& file, const Camera& camera, glm::ivec2 window);

// Whether it shows what a picture of that size shows of that camera.
bool isOf(const Truth& truth, const Camera& camera, glm::ivec2 size);

}  // namespace loden::walk
