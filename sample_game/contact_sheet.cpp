#include "sample_game/contact_sheet.h"

#include <algorithm>
#include <cmath>

#include "material/base/check.h"
#include "material/model/color.h"

namespace loden::walk {
namespace {

constexpr int kGap = 4;  // pixels between cells

// Average over the pixels of box [low, high), linear.
glm::dvec3 average(std::span<const glm::u8vec4> frame, int width, glm::ivec2 low, glm::ivec2 high) {
  glm::dvec3 sum(0);
  for (int y = low.y; y < high.y; ++y)
    for (int x = low.x; x < high.x; ++x) {
      const glm::u8vec4& code = frame[size_t(y) * width + x];
      sum += glm::dvec3(linearFromSrgb(code.r / 255.0), linearFromSrgb(code.g / 255.0),
                        linearFromSrgb(code.b / 255.0));
    }
  return sum / (double(high.x - low.x) * (high.y - low.y));
}

uint8_t codeOf(double linear) {
  return static_cast<uint8_t>(std::lround(255 * std::clamp(srgbFromLinear(linear), 0.0, 1.0)));
}

}  // namespace

ContactSheet::ContactSheet(int cells, glm::ivec2 frame, int width) : frame_(frame) {
  LODEN_CHECK_LT(0, cells);
  grid_.x = static_cast<int>(std::ceil(std::sqrt(double(cells))));
  grid_.y = (cells + grid_.x - 1) / grid_.x;
  cell_.x = std::max(1, std::min(frame.x, width / grid_.x - kGap));
  cell_.y = std::max(1, static_cast<int>(std::lround(double(cell_.x) * frame.y / frame.x)));
  size_ = grid_ * (cell_ + kGap) + kGap;
  pixels_.assign(size_t(size_.x) * size_.y, {0, 0, 0, 255});
}

void ContactSheet::add(std::span<const glm::u8vec4> frame) {
  LODEN_CHECK_EQ(frame.size(), size_t(frame_.x) * frame_.y);
  LODEN_CHECK_LT(added_, cells());
  const glm::ivec2 origin = glm::ivec2(added_ % grid_.x, added_ / grid_.x) * (cell_ + kGap) + kGap;
  ++added_;
  for (int y = 0; y < cell_.y; ++y)
    for (int x = 0; x < cell_.x; ++x) {
      const glm::ivec2 low = glm::ivec2(x, y) * frame_ / cell_;
      const glm::ivec2 high = glm::max(glm::ivec2(x + 1, y + 1) * frame_ / cell_, low + 1);
      const glm::dvec3 c = average(frame, frame_.x, low, high);
      pixels_[size_t(origin.y + y) * size_.x + origin.x + x] = {codeOf(c.r), codeOf(c.g), codeOf(c.b), 255};
    }
}

bool onContactSheet(int frame, int frames, int cells) {
  if (frames <= cells) return true;
  // Cell k shows frame round(k (frames - 1) / (cells - 1)).
  const double k = std::round(double(frame) * (cells - 1) / (frames - 1));
  return std::lround(k * (frames - 1) / (cells - 1)) == frame;
}

}  // namespace loden::walk
