#include "runtime/scene/image_decode.h"

#include <png.h>
#include <turbojpeg.h>
#include <webp/decode.h>

#include <algorithm>
#include <csetjmp>
#include <cstring>
#include <limits>
#include <memory>

#include "material/base/issues.h"

namespace loden::runtime {
namespace {

using Bytes = std::span<const std::byte>;

Issue badImage(const std::string& name, const std::string& text) {
  return {issue_id::kImage, Severity::kError, name, text};
}

const uint8_t* data(Bytes bytes) {
  return reinterpret_cast<const uint8_t*>(bytes.data());
}

bool startsWith(Bytes bytes, std::string_view magic) {
  return bytes.size() >= magic.size() && std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}

// Empty if the picture may be decoded.
std::string beyondLimits(uint64_t width, uint64_t height, uint64_t most_pixels) {
  const std::string size = std::to_string(width) + " x " + std::to_string(height) + " pixels";
  if (width < 1 || height < 1) return "has no pixels";
  if (width > kMaxImageSide || height > kMaxImageSide)
    return "has " + size + ", and no side may exceed " + std::to_string(kMaxImageSide);
  if (width * height > most_pixels)
    return "has " + size + ", more than the " + std::to_string(most_pixels) + " that are left to decode";
  return {};
}

SceneImage emptyImage(const std::string& name, uint64_t width, uint64_t height) {
  SceneImage image{name, {static_cast<int>(width), static_cast<int>(height)}, {}};
  image.pixels.resize(size_t(width) * size_t(height));
  return image;
}

// libpng reports errors by a long jump, so that nothing in readPng may need a destructor: its parts live
// here, outside.
struct PngReader {
  Bytes bytes;
  uint64_t most_pixels = 0;
  std::string message;
  png_structp png = nullptr;
  png_infop info = nullptr;
  SceneImage image;
  std::vector<png_bytep> rows;

  ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }
};

void readPngBytes(png_structp png, png_bytep out, size_t size) {
  auto* self = static_cast<PngReader*>(png_get_io_ptr(png));
  if (size > self->bytes.size()) png_error(png, "it ends early");
  std::memcpy(out, self->bytes.data(), size);
  self->bytes = self->bytes.subspan(size);
}

void failPng(png_structp png, png_const_charp message) {
  static_cast<PngReader*>(png_get_error_ptr(png))->message = message;
  png_longjmp(png, 1);
}

void ignorePngWarning(png_structp, png_const_charp) {}

// All kinds of PNG to RGBA of 8 bits.
void expandPng(png_structp png, png_infop info) {
  if (png_get_bit_depth(png, info) == 16) png_set_scale_16(png);
  png_set_expand(png);
  png_set_gray_to_rgb(png);
  png_set_add_alpha(png, 0xFF, PNG_FILLER_AFTER);
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
}

void preparePixels(PngReader& self) {
  const uint64_t width = png_get_image_width(self.png, self.info),
                 height = png_get_image_height(self.png, self.info);
  self.message = beyondLimits(width, height, self.most_pixels);
  if (!self.message.empty()) return;
  self.image = emptyImage(self.image.name, width, height);
  for (uint64_t y = 0; y < height; ++y)
    self.rows.push_back(reinterpret_cast<png_bytep>(self.image.pixels.data() + y * width));
}

bool readPng(PngReader& self) {
  self.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &self, &failPng, &ignorePngWarning);
  if (self.png) self.info = png_create_info_struct(self.png);
  if (!self.info) return false;
  if (setjmp(png_jmpbuf(self.png))) return false;
  png_set_user_limits(self.png, kMaxImageSide, kMaxImageSide);
  png_set_chunk_cache_max(self.png, 16);
  png_set_chunk_malloc_max(self.png, 1 << 20);
  png_set_read_fn(self.png, &self, &readPngBytes);
  png_read_info(self.png, self.info);
  preparePixels(self);
  if (!self.message.empty()) return false;
  expandPng(self.png, self.info);
  if (png_get_rowbytes(self.png, self.info) != 4 * size_t(self.image.size.x)) return false;
  png_read_image(self.png, self.rows.data());
  return true;
}

Result<SceneImage> decodePng(Bytes bytes, const std::string& name, uint64_t most_pixels) {
  PngReader reader;
  reader.bytes = bytes;
  reader.most_pixels = most_pixels;
  reader.image.name = name;
  if (!readPng(reader))
    return badImage(name, "is no whole PNG: " + (reader.message.empty() ? "no memory" : reader.message));
  return std::move(reader.image);
}

Result<SceneImage> decodeJpeg(Bytes bytes, const std::string& name, uint64_t most_pixels) {
  struct Close {
    void operator()(void* handle) const { tjDestroy(handle); }
  };
  const std::unique_ptr<void, Close> decoder(tjInitDecompress());
  if (!decoder || bytes.size() > std::numeric_limits<int>::max()) return badImage(name, "is too large");
  const auto size = static_cast<unsigned long>(bytes.size());  // NOLINT: the library's own type
  int width = 0, height = 0, subsampling = 0, color = 0;
  if (tjDecompressHeader3(decoder.get(), data(bytes), size, &width, &height, &subsampling, &color) != 0)
    return badImage(name, std::string("is no JPEG: ") + tjGetErrorStr2(decoder.get()));
  if (color == TJCS_CMYK || color == TJCS_YCCK)
    return badImage(name, "is a JPEG in CMYK, which glTF has not");
  if (const std::string beyond =
          beyondLimits(uint64_t(std::max(width, 0)), uint64_t(std::max(height, 0)), most_pixels);
      !beyond.empty())
    return badImage(name, beyond);
  SceneImage image = emptyImage(name, uint64_t(width), uint64_t(height));
  auto* pixels = reinterpret_cast<unsigned char*>(image.pixels.data());
  constexpr int kFlags = TJFLAG_ACCURATEDCT | TJFLAG_STOPONWARNING | TJFLAG_LIMITSCANS;
  if (tjDecompress2(decoder.get(), data(bytes), size, pixels, width, 0, height, TJPF_RGBA, kFlags) != 0)
    return badImage(name, std::string("is no whole JPEG: ") + tjGetErrorStr2(decoder.get()));
  return image;
}

Result<SceneImage> decodeWebp(Bytes bytes, const std::string& name, uint64_t most_pixels) {
  int width = 0, height = 0;
  if (!WebPGetInfo(data(bytes), bytes.size(), &width, &height)) return badImage(name, "is no WebP");
  if (const std::string beyond =
          beyondLimits(uint64_t(std::max(width, 0)), uint64_t(std::max(height, 0)), most_pixels);
      !beyond.empty())
    return badImage(name, beyond);
  SceneImage image = emptyImage(name, uint64_t(width), uint64_t(height));
  auto* pixels = reinterpret_cast<uint8_t*>(image.pixels.data());
  const size_t room = image.pixels.size() * sizeof(glm::u8vec4);
  if (!WebPDecodeRGBAInto(data(bytes), bytes.size(), pixels, room, 4 * width))
    return badImage(name, "is no whole WebP");
  return image;
}

}  // namespace

Result<SceneImage> decodeImage(Bytes bytes, const std::string& name, uint64_t most_pixels) {
  most_pixels = std::min(most_pixels, kMaxImagePixels);
  if (startsWith(bytes, "\x89PNG\r\n\x1a\n")) return decodePng(bytes, name, most_pixels);
  if (startsWith(bytes, "\xff\xd8\xff")) return decodeJpeg(bytes, name, most_pixels);
  if (startsWith(bytes, "RIFF") && bytes.size() > 12 && startsWith(bytes.subspan(8), "WEBP"))
    return decodeWebp(bytes, name, most_pixels);
  if (startsWith(bytes, "\xabKTX 20")) return badImage(name, "is a KTX2, which is not decoded");
  return badImage(name, "is neither PNG, JPEG nor WebP");
}

}  // namespace loden::runtime
