// Pictures from PNG, JPEG and WebP files, whole, damaged and too large.
#include <gtest/gtest.h>
#include <turbojpeg.h>
#include <webp/encode.h>

#include <cstdlib>
#include <fstream>
#include <string>

#include "material/base/issues.h"
#include "runtime/scene/image_decode.h"
#include "runtime/scene/image_write.h"
#include "tests/unit/gltf_builder.h"

namespace loden::test {
namespace {

using namespace runtime;

std::span<const std::byte> bytesOf(const std::string& text) {
  return std::as_bytes(std::span(text));
}

std::vector<glm::u8vec4> gradient(int side) {
  std::vector<glm::u8vec4> pixels;
  for (int i = 0; i < side * side; ++i) pixels.emplace_back(i % side * 8, i / side * 8, 100, 255);
  return pixels;
}

std::string pngOf(const std::vector<glm::u8vec4>& pixels, glm::ivec2 size) {
  const GltfBuilder folder;  // for its place on the disk
  const auto path = folder.folder() / "picture.png";
  EXPECT_TRUE(writePng(path, pixels, size).ok());
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string jpegOf(const std::vector<glm::u8vec4>& pixels, int side) {
  tjhandle encoder = tjInitCompress();
  unsigned char* bytes = nullptr;
  unsigned long size = 0;  // NOLINT: the library's own type
  EXPECT_EQ(tjCompress2(encoder, reinterpret_cast<const unsigned char*>(pixels.data()), side, 0, side,
                        TJPF_RGBA, &bytes, &size, TJSAMP_444, 95, 0),
            0);
  std::string text(reinterpret_cast<char*>(bytes), size);
  tjFree(bytes);
  tjDestroy(encoder);
  return text;
}

std::string webpOf(const std::vector<glm::u8vec4>& pixels, int side) {
  uint8_t* bytes = nullptr;
  const size_t size =
      WebPEncodeLosslessRGBA(reinterpret_cast<const uint8_t*>(pixels.data()), side, side, 4 * side, &bytes);
  std::string text(reinterpret_cast<char*>(bytes), size);
  WebPFree(bytes);
  return text;
}

TEST(ImageDecode, ReadsWhatWasWritten) {
  const auto pixels = gradient(16);
  for (const std::string& file : {pngOf(pixels, {16, 16}), webpOf(pixels, 16)}) {
    const auto image = decodeImage(bytesOf(file), "picture");
    ASSERT_TRUE(image.ok()) << image.issue().text;
    EXPECT_EQ(image->size, glm::ivec2(16));
    EXPECT_TRUE(image->pixels == pixels);
  }
  const auto jpeg = decodeImage(bytesOf(jpegOf(pixels, 16)), "picture");
  ASSERT_TRUE(jpeg.ok()) << jpeg.issue().text;
  for (size_t i = 0; i < pixels.size(); ++i)
    for (int c = 0; c < 4; ++c) EXPECT_NEAR(jpeg->pixels[i][c], pixels[i][c], 12) << "lossy";
}

TEST(ImageDecode, RefusesFilesThatAreCutShort) {
  const auto pixels = gradient(16);
  for (const std::string& file : {pngOf(pixels, {16, 16}), webpOf(pixels, 16), jpegOf(pixels, 16)})
    for (size_t size = 0; size + 16 < file.size(); ++size) {  // a PNG's last chunk holds nothing
      const auto image = decodeImage(bytesOf(file.substr(0, size)), "picture");
      ASSERT_FALSE(image.ok()) << size << " of " << file.size();
      EXPECT_EQ(image.issue().id, issue_id::kImage);
      EXPECT_EQ(image.issue().where, "picture");
    }
}

TEST(ImageDecode, SurvivesEveryDamagedByte) {
  const auto pixels = gradient(12);
  for (const std::string& file : {pngOf(pixels, {12, 12}), webpOf(pixels, 12), jpegOf(pixels, 12)})
    for (size_t at = 0; at < file.size(); ++at)
      for (const char damage : {'\x00', '\xff', '\x41'}) {
        std::string damaged = file;
        damaged[at] = damage;
        const auto image = decodeImage(bytesOf(damaged), "picture", 1 << 20);
        if (!image.ok()) continue;
        EXPECT_EQ(image->pixels.size(), size_t(image->size.x) * size_t(image->size.y));
      }
}

// A header may promise more than memory holds: nothing is allocated for it.
TEST(ImageDecode, ChecksSizesBeforeItDecodes) {
  std::string png = pngOf(gradient(4), {4, 4});
  const auto image = decodeImage(bytesOf(png), "picture", 15);
  ASSERT_FALSE(image.ok());
  EXPECT_NE(image.issue().text.find("4 x 4"), std::string::npos) << image.issue().text;
  std::string jpeg = jpegOf(gradient(16), 16);
  const size_t frame = jpeg.find("\xff\xc0");
  ASSERT_NE(frame, std::string::npos);
  jpeg.replace(frame + 5, 4, "\xff\xff\xff\xff");  // height, width
  EXPECT_FALSE(decodeImage(bytesOf(jpeg), "picture").ok());
}

TEST(ImageDecode, NamesWhatItCannotRead) {
  for (const std::string& file :
       {std::string(), std::string("GIF89a"), std::string("\xabKTX 20\xbb\r\n\x1a\n")})
    EXPECT_EQ(decodeImage(bytesOf(file), "picture").issue().id, issue_id::kImage);
  EXPECT_NE(decodeImage(bytesOf("\xabKTX 20\xbb"), "picture").issue().text.find("KTX2"), std::string::npos);
}

}  // namespace
}  // namespace loden::test
