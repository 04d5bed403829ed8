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
// Reads the picture, which must have the proportions of a window of that size, to a pixel. Issues: those of
// openFileSource and decodeImage; kOption if the proportions differ.
Result<Truth> readTruth(const std::filesystem::path& file, const Camera& camera, glm::ivec2 window);

// Whether the truth shows what a picture of that size shows from that camera.
bool isOf(const Truth& truth, const Camera& camera, glm::ivec2 size);

}  // namespace loden::walk
