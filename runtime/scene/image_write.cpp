#include "runtime/scene/image_write.h"

#include <vector>

#include "material/base/check.h"
#include "material/base/issues.h"
#include "material/system/atomic_file.h"

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace loden::runtime {

Status writePng(const std::filesystem::path& path, std::span<const glm::u8vec4> pixels, glm::ivec2 size) {
  LODEN_CHECK_EQ(pixels.size(), size_t(size.x) * size_t(size.y));
  std::vector<std::byte> file;
  const auto append = [](void* context, void* data, int bytes) {
    const std::byte* begin = static_cast<const std::byte*>(data);
    auto& all = *static_cast<std::vector<std::byte>*>(context);
    all.insert(all.end(), begin, begin + bytes);
  };
  if (!stbi_write_png_to_func(append, &file, size.x, size.y, 4, pixels.data(), size.x * 4))
    return Issue{issue_id::kMemory, Severity::kError, path.string(), "the picture could not be compressed"};
  return writeFileAtomically(path, file);
}

}  // namespace loden::runtime
