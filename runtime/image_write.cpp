#include "runtime/image_write.h"

#include <fstream>

#include "material/issues.h"

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
  const auto fail = [&](const char* why) { return Issue{issue_id::kCannotWrite, Severity::kError, path.string(), why}; };
  const std::filesystem::path temporary = path.string() + ".part";
  std::ofstream out(temporary, std::ios::binary);
  if (!out) return fail("cannot be opened for writing");
  const auto append = [](void* context, void* data, int bytes) {
    static_cast<std::ofstream*>(context)->write(static_cast<const char*>(data), bytes);
  };
  stbi_write_png_to_func(append, &out, size.x, size.y, 4, pixels.data(), size.x * 4);
  out.close();
  std::error_code error;
  if (out) std::filesystem::rename(temporary, path, error);
  if (out && !error) return {};
  std::filesystem::remove(temporary, error);
  return fail("could not be written completely");
}

}  // namespace loden::runtime
