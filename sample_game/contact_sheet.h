// Many frames in one picture.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace loden::walk {

// A grid of frames, area-averaged in linear light as they arrive, in reading order.
class ContactSheet {
 public:
  // Room for `cells` pictures of `frame` pixels, in a sheet about `width` pixels wide.
  ContactSheet(int cells, glm::ivec2 frame, int width = 1600);

  int cells() const { return grid_.x * grid_.y; }
  glm::ivec2 size() const { return size_; }
  // sRGB codes, first row at the top; cells beyond the last that was added stay black.
  void add(std::span<const glm::u8vec4> frame);
  std::span<const glm::u8vec4> pixels() const { return pixels_; }

 private:
  glm::ivec2 frame_, grid_{1, 1}, cell_{1, 1}, size_{1, 1};
  int added_ = 0;
  std::vector<glm::u8vec4> pixels_;
};

// Which of `frames` frames go into a sheet of `cells` pictures: evenly spread, the first and the last among
// them.
bool onContactSheet(int frame, int frames, int cells);

}  // namespace loden::walk
