#include "importer/base/image_file.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>

#include "importer/base/file_read.h"
#include "importer/base/image_encode.h"
#include "material/base/check.h"
#include "material/base/issues.h"

namespace loden::importer {
namespace {

namespace fs = std::filesystem;

OIIO::TypeDesc oiioType(PixelType type) {
  switch (type) {
    case PixelType::kHalf:
      return OIIO::TypeDesc::HALF;
    case PixelType::kFloat:
      return OIIO::TypeDesc::FLOAT;
    case PixelType::kByte:
      return OIIO::TypeDesc::UINT8;
  }
  return OIIO::TypeDesc::FLOAT;
}

}  // namespace

Status writeImage(const fs::path& path, int width, int height, int channels, PixelType type,
                  std::span<const float> pixels) {
  LODEN_CHECK_EQ(pixels.size(), size_t(width) * size_t(height) * size_t(channels));
  OIIO::ImageSpec spec(width, height, channels, oiioType(type));
  spec.attribute("DateTime", "1970:01:01 00:00:00");  // else the writing time: equal bakes have equal bytes
  if (path.extension() == ".exr") spec.attribute("compression", "zip:1");
  return writeEncoded(path, spec, OIIO::TypeDesc::FLOAT, pixels.data(), Flush::kLater);
}

Result<Image> readImage(const fs::path& path) {
  if (Status status = checkOpens(path, Openable::kFile); !status) return status.issue();
  const auto input = OIIO::ImageInput::open(path.string());
  if (!input)
    return Issue{issue_id::kImage, Severity::kError, path.string(),
                 "is no image that can be read: " + OIIO::geterror()};
  const OIIO::ImageSpec& spec = input->spec();
  Image image{spec.width, spec.height, spec.nchannels, {}};
  image.pixels.resize(size_t(spec.width) * size_t(spec.height) * size_t(spec.nchannels));
  if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, image.pixels.data()))
    return Issue{issue_id::kImage, Severity::kError, path.string(), "cannot be read: " + input->geterror()};
  return image;
}

glm::ivec2 imageExtents(std::span<const unsigned char> bytes) {
  constexpr unsigned char kPng[] = {0x89, 'P', 'N', 'G'}, kJpeg[] = {0xff, 0xd8};
  const auto begins = [&](std::span<const unsigned char> mark) {
    return bytes.size() >= mark.size() && std::equal(mark.begin(), mark.end(), bytes.begin());
  };
  const char* name = begins(kPng) ? "memory.png" : begins(kJpeg) ? "memory.jpg" : nullptr;
  if (name == nullptr) return {0, 0};
  OIIO::Filesystem::IOMemReader memory(bytes.data(), bytes.size());
  const auto input = OIIO::ImageInput::open(name, nullptr, &memory);
  if (!input) return OIIO::geterror(), glm::ivec2(0);
  return {input->spec().width, input->spec().height};
}

}  // namespace loden::importer
