#include "importer/base/image_encode.h"

#include <OpenImageIO/filesystem.h>

#include <memory>
#include <span>

#include "material/base/issues.h"

namespace loden::importer {

Result<std::vector<unsigned char>> encodeImage(const std::string& name, const OIIO::ImageSpec& spec,
                                               OIIO::TypeDesc type, const void* pixels,
                                               ptrdiff_t pixel_bytes) {
  const auto cannot = [&](const std::string& why) {
    return Issue{issue_id::kImage, Severity::kError, name, "cannot be encoded: " + why};
  };
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  const auto output = OIIO::ImageOutput::create(name);
  if (!output) return cannot(OIIO::geterror());
  if (!output->set_ioproxy(&memory)) return cannot("the format is not written to memory");
  if (!output->open(name, spec)) return cannot(output->geterror());
  const bool written = output->write_image(type, pixels, pixel_bytes);
  if (!output->close() || !written) return cannot(output->geterror());
  return bytes;
}

Status writeEncoded(const std::filesystem::path& path, const OIIO::ImageSpec& spec, OIIO::TypeDesc type,
                    const void* pixels, Flush flush, ptrdiff_t pixel_bytes) {
  const auto bytes = encodeImage(path.string(), spec, type, pixels, pixel_bytes);
  if (!bytes) return bytes.issue();
  return writeFileAtomically(path, std::as_bytes(std::span(*bytes)), flush);
}

}  // namespace loden::importer
