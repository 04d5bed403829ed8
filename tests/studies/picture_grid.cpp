// Puts pictures of one size side by side: picture_grid OUTPUT COLUMNS PICTURE... (reading order).
// Or halves one: picture_grid --halve OUTPUT PICTURE; each pixel is the mean of 2 x 2, in linear light.
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "importer/base/picture.h"

namespace {

using loden::importer::Picture;

constexpr int kGap = 4;  // pixels of white between pictures

void paste(const Picture& from, Picture& into, int left, int top) {
  for (int y = 0; y < from.height; ++y)
    for (int x = 0; x < from.width; ++x) into.at(left + x, top + y) = from.at(x, y);
}

int fail(const std::string& text) {
  std::fprintf(stderr, "picture_grid: %s\n", text.c_str());
  return 1;
}

int writeHalved(const char* output, const char* input) {
  const auto whole = loden::importer::readPicture(input);
  if (!whole) return fail(whole.issue().where + ": " + whole.issue().text);
  Picture half{whole->width / 2, whole->height / 2, {}};
  for (int y = 0; y < half.height; ++y)
    for (int x = 0; x < half.width; ++x)
      half.pixels.push_back((whole->at(2 * x, 2 * y) + whole->at(2 * x + 1, 2 * y) +
                             whole->at(2 * x, 2 * y + 1) + whole->at(2 * x + 1, 2 * y + 1)) *
                            0.25f);
  const auto written = loden::importer::writePicture(half, output);
  return written ? 0 : fail(written.issue().text);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 4 && std::string_view(argv[1]) == "--halve") return writeHalved(argv[2], argv[3]);
  const int count = argc - 3, columns = argc > 3 ? std::atoi(argv[2]) : 0;
  if (columns < 1) return fail("usage: picture_grid OUTPUT COLUMNS PICTURE...");
  Picture grid;
  int width = 0, height = 0;
  for (int i = 0; i < count; ++i) {
    const auto picture = loden::importer::readPicture(argv[3 + i]);
    if (!picture) return fail(picture.issue().where + ": " + picture.issue().text);
    if (i == 0) {
      width = picture->width, height = picture->height;
      grid.width = columns * (width + kGap) - kGap;
      grid.height = (count + columns - 1) / columns * (height + kGap) - kGap;
      grid.pixels.assign(size_t(grid.width) * grid.height, glm::vec4(1));
    }
    if (picture->width != width || picture->height != height)
      return fail(std::string(argv[3 + i]) + ": another size");
    paste(*picture, grid, i % columns * (width + kGap), i / columns * (height + kGap));
  }
  const auto written = loden::importer::writePicture(grid, argv[1]);
  return written ? 0 : fail(written.issue().text);
}
