#include "importer/base/image_file.h"

#include <OpenImageIO/imageio.h>

#include "importer/base/file_read.h"
#include "importer/base/temporary_file.h"
#include "material/base/check.h"
#include "material/base/issues.h"

namespace loden::importer {
namespace {

namespace fs = std::filesystem;

// The same name every time: a killed run's leftover is overwritten by the next.
fs::path temporaryName(const fs::path& path) {
  std::string name(".");
  name += path.stem().string();
  return path.parent_path() / (name + ".tmp" + path.extension().string());
}

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

Issue cannotWrite(const fs::path& path, const std::string& why) {
  return {issue_id::kCannotWrite, Severity::kError, path.string(), "cannot be written: " + why};
}

}  // namespace

Status writeImage(const fs::path& path, int width, int height, int channels, PixelType type,
                  std::span<const float> pixels) {
  LODEN_CHECK_EQ(pixels.size(), size_t(width) * size_t(height) * size_t(channels));
  TemporaryFile temporary(temporaryName(path));
  const auto output = OIIO::ImageOutput::create(temporary.path().string());
  if (!output) return cannotWrite(path, OIIO::geterror());
  OIIO::ImageSpec spec(width, height, channels, oiioType(type));
  spec.attribute("DateTime", "1970:01:01 00:00:00");  // else the writing time: equal bakes have equal bytes
  if (path.extension() == ".exr") spec.attribute("compression", "zip:1");
  if (!output->open(temporary.path().string(), spec)) return cannotWrite(path, output->geterror());
  const bool written = output->write_image(OIIO::TypeDesc::FLOAT, pixels.data());
  if (!output->close() || !written) return cannotWrite(path, output->geterror());
  if (const std::error_code error = temporary.renameTo(path)) return cannotWrite(path, error.message());
  return {};
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

}  // namespace loden::importer
