// Decodes PNG, JPEG and WebP files, which are untrusted input.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "material/base/result.h"
#include "runtime/scene/scene.h"

namespace loden::runtime {

inline constexpr int kMaxImageSide = 16384;  // pixels
inline constexpr uint64_t kMaxImagePixels = uint64_t(1) << 26;

// The picture as 8-bit RGBA, whatever the file's own channels and depth: grey fills red, green and blue,
// alpha is opaque where there is none, and 16-bit codes are rounded. Colour profiles and gamma are ignored,
// as glTF requires. Size limits are checked before anything is allocated. Issues: kImage, at `name`, if the
// bytes are not such a picture, are cut short, or are larger than the limits or than `most_pixels`.
Result<SceneImage> decodeImage(std::span<const std::byte> bytes, const std::string& name,
                               uint64_t most_pixels = kMaxImagePixels);

}  // namespace loden::runtime
