// Encodes pictures in memory and writes them whole, so that a full disk is noticed even if a format's library
// would not report it. Not installed.
#pragma once

#include <OpenImageIO/imageio.h>

#include <cstddef>
#include <filesystem>
#include <vector>

#include "material/base/result.h"
#include "material/system/atomic_file.h"

namespace loden::importer {

// The file's bytes in the format of `name`'s extension. `pixels` are of type `type`, row 0 first,
// `pixel_bytes` apart, or tightly packed by default. Issues: kImage if the format cannot hold `spec`.
Result<std::vector<unsigned char>> encodeImage(const std::string& name, const OIIO::ImageSpec& spec,
                                               OIIO::TypeDesc type, const void* pixels,
                                               ptrdiff_t pixel_bytes = OIIO::AutoStride);

// Writes the result of encodeImage with writeFileAtomically.
Status writeEncoded(const std::filesystem::path& path, const OIIO::ImageSpec& spec, OIIO::TypeDesc type,
                    const void* pixels, Flush flush, ptrdiff_t pixel_bytes = OIIO::AutoStride);

}  // namespace loden::importer
