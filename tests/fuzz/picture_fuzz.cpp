// Any bytes as a picture (PNG, JPEG, WebP) and as a Radiance panorama: no crash, and what is accepted has as
// many pixels as it says.
#include <cstdint>

#include "runtime/scene/image_decode.h"
#include "runtime/scene/image_read.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using loden::fuzz::require;
  static const loden::fuzz::InputFolder folder;
  constexpr uint64_t kMostPixels = 1 << 20;  // for speed
  const auto picture = loden::runtime::decodeImage(std::as_bytes(std::span(data, size)), "fuzz", kMostPixels);
  if (picture) {
    const uint64_t pixels = uint64_t(picture->size.x) * uint64_t(picture->size.y);
    require(pixels > 0 && pixels <= kMostPixels && picture->pixels.size() == pixels);
  }
  const auto panorama =
      loden::runtime::readPanorama(folder.write("input.hdr", loden::fuzz::textOf(data, size)));
  if (panorama)
    require(panorama->pixels.size() == size_t(panorama->width) * size_t(panorama->height) &&
            !panorama->pixels.empty());
  return 0;
}
