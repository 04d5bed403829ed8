// Puts pictures of one size side by side: picture_grid OUTPUT COLUMNS PICTURE... (reading order).
#include <cstdio>
#include <cstdlib>
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

}  // namespace

int main(int argc, char** argv) {
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
