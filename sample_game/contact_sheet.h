// A contact sheet: many frames of a walk in one picture.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace loden::walk {

// A grid of frames in reading order. Each frame is reduced to its cell, in linear light, when it is added.
class ContactSheet {
 public:
  // Room for `cells` pictures of `frame` pixels, in a sheet about `width` pixels wide.
  ContactSheet(int cells, glm::ivec2 frame, int width = 1600);

  int cells() const { return grid_.x * grid_.y; }
  glm::ivec2 size() const { return size_; }
  // Adds a frame to the next cell. Frames and pixels() are sRGB codes, first row at the top; cells that no
  // frame was added to are black.
  void add(std::span<const glm::u8vec4> frame);
  std::span<const glm::u8vec4> pixels() const { return pixels_; }

 private:
  glm::ivec2 frame_, grid_{1, 1}, cell_{1, 1}, size_{1, 1};
  int added_ = 0;
  std::vector<glm::u8vec4> pixels_;
};

// Whether frame `frame` of `frames` goes into a sheet of `cells` pictures. Those that do are evenly spread;
// the first and the last are among them.
bool onContactSheet(int frame, int frames, int cells);

}  // namespace loden::walk
