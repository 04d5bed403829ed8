#include "importer/study/figure.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "material/model/color.h"

namespace loden::importer {

Picture texelPicture(std::span<const glm::vec3> texels, int side, int magnify) {
  const int pixels = side * magnify;
  Picture picture{pixels, pixels, std::vector<glm::vec4>(size_t(pixels) * size_t(pixels))};
  for (int y = 0; y < pixels; ++y)
    for (int x = 0; x < pixels; ++x)
      picture.at(x, pixels - 1 - y) =
          glm::vec4(texels[size_t(y / magnify) * size_t(side) + size_t(x / magnify)], 1);
  return picture;
}

Picture logarithmicPicture(std::span<const double> values, int side, double least, double most) {
  std::vector<glm::vec3> gray;
  gray.reserve(values.size());
  for (const double value : values) {
    const double code = std::log(std::max(value, least) / least) / std::log(most / least);
    gray.push_back(value < 0 ? glm::vec3(0, 0, .3f) : glm::vec3(float(linearFromSrgb(std::min(code, 1.0)))));
  }
  return texelPicture(gray, side);
}

Status writeFigure(const Picture& picture, const std::filesystem::path& path) {
  std::error_code ignored;  // the write says what is wrong
  if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path(), ignored);
  return writePicture(picture, path);
}

}  // namespace loden::importer
