#include "importer/base/picture.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "importer/base/file_read.h"
#include "importer/base/image_encode.h"
#include "material/base/issues.h"
#include "material/model/color.h"

namespace loden::importer {
namespace {

constexpr int kMaxSide = 16384;

Issue imageIssue(const std::filesystem::path& path, const std::string& text) {
  return {issue_id::kImage, Severity::kError, path.string(), text};
}

// 8 bits are nearly always the input: a table instead of powers.
float decodedSrgb(float code) {
  static const auto table = [] {
    std::array<float, 256> values{};
    for (int i = 0; i < 256; ++i) values[i] = static_cast<float>(linearFromSrgb(i / 255.0));
    return values;
  }();
  const float scaled = code * 255;
  const float rounded = std::round(scaled);
  if (std::abs(scaled - rounded) < 1e-4f) return table[std::clamp(static_cast<int>(rounded), 0, 255)];
  return static_cast<float>(linearFromSrgb(code));
}

unsigned char encodedSrgb(float linear) {
  const double code = srgbFromLinear(std::clamp(linear, 0.f, 1.f)) * 255 + 0.5;
  return static_cast<unsigned char>(std::clamp(code, 0.0, 255.0));
}

Picture fromChannels(const std::vector<float>& values, int width, int height, int channels, bool srgb) {
  Picture picture{width, height, std::vector<glm::vec4>(size_t(width) * height, glm::vec4(0, 0, 0, 1))};
  const bool gray = channels < 3;
  for (size_t i = 0; i < picture.pixels.size(); ++i) {
    const float* in = &values[i * channels];
    for (int c = 0; c < 3; ++c)
      picture.pixels[i][c] = srgb ? decodedSrgb(in[gray ? 0 : c]) : in[gray ? 0 : c];
    if (channels == 2 || channels >= 4) picture.pixels[i].w = in[channels == 2 ? 1 : 3];
  }
  return picture;
}

std::vector<unsigned char> rgb8From(const Picture& picture) {
  std::vector<unsigned char> bytes;
  bytes.reserve(picture.pixels.size() * 3);
  for (const glm::vec4& pixel : picture.pixels)
    for (int c = 0; c < 3; ++c) bytes.push_back(encodedSrgb(pixel[c]));
  return bytes;
}

std::string loweredExtension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return extension;
}

bool isInteger(const std::string& extension) {
  return extension == ".png" || extension == ".jpg" || extension == ".jpeg";
}

}  // namespace

Result<Picture> readPicture(const std::filesystem::path& path) {
  if (Status status = checkOpens(path, Openable::kFile); !status) return status.issue();
  const auto input = OIIO::ImageInput::open(path.string());
  if (!input) return imageIssue(path, "is no image that can be read: " + OIIO::geterror());
  const OIIO::ImageSpec& spec = input->spec();
  if (spec.width < 1 || spec.height < 1 || spec.width > kMaxSide || spec.height > kMaxSide || spec.depth > 1)
    return imageIssue(path, "sides must be 1 to 16384");
  std::vector<float> values(size_t(spec.width) * spec.height * spec.nchannels);
  if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeFloat, values.data()))
    return imageIssue(path, "cannot be decoded: " + input->geterror());
  const bool srgb = !spec.format.is_floating_point();
  return fromChannels(values, spec.width, spec.height, spec.nchannels, srgb);
}

Status checkPictureName(const std::filesystem::path& path) {
  const std::string extension = loweredExtension(path);
  if (isInteger(extension) || extension == ".exr" || extension == ".hdr") return {};
  return Issue{issue_id::kOption, Severity::kError, path.string(),
               "output must end in .exr, .hdr, .png or .jpg"};
}

Status writePicture(const Picture& picture, const std::filesystem::path& path, Flush flush) {
  if (Status status = checkPictureName(path); !status) return status;
  const std::string extension = loweredExtension(path);
  const bool integer = isInteger(extension);
  const int channels = extension == ".exr" ? 4 : 3;
  OIIO::ImageSpec spec(picture.width, picture.height, channels, integer ? OIIO::TypeUInt8 : OIIO::TypeFloat);
  if (!integer)
    return writeEncoded(path, spec, OIIO::TypeFloat, picture.pixels.data(), flush, sizeof(glm::vec4));
  spec.attribute("oiio:ColorSpace", "sRGB");
  return writeEncoded(path, spec, OIIO::TypeUInt8, rgb8From(picture).data(), flush);
}

Result<std::vector<unsigned char>> encodeRgb8(const std::vector<unsigned char>& rgb, int width, int height,
                                              PictureCodec codec) {
  OIIO::ImageSpec spec(width, height, 3, OIIO::TypeUInt8);
  spec.attribute("png:compressionLevel", 9);
  spec.attribute("Compression", "jpeg:100");
  spec.attribute("jpeg:subsampling", "4:4:4");
  return encodeImage(codec == PictureCodec::kPng ? "memory.png" : "memory.jpg", spec, OIIO::TypeUInt8,
                     rgb.data());
}

}  // namespace loden::importer
