#include "sample_game/truth.h"

#include <cmath>

#include "material/base/issues.h"
#include "material/system/asset_io.h"
#include "runtime/scene/image_decode.h"

namespace loden::walk {
namespace {

bool sameProportions(glm::ivec2 a, glm::ivec2 b) {
  return std::abs(int64_t(a.x) * b.y - int64_t(b.x) * a.y) <= std::max(a.x, a.y);
}

}  // namespace

Result<Truth> readTruth(const std::filesystem::path& file, const Camera& camera, glm::ivec2 window) {
  const auto source = openFileSource(file);
  if (!source) return source.issue();
  std::vector<std::byte> bytes((*source)->size());
  if (const Status status = (*source)->read(0, bytes); !status) return status.issue();
  auto image = runtime::decodeImage(bytes, file.string());
  if (!image) return image.issue();
  if (!sameProportions(image->size, window))
    return Issue{issue_id::kOption, Severity::kError, file.string(),
                 "has " + std::to_string(image->size.x) + " x " + std::to_string(image->size.y) +
                     " pixels, and --size asks for " + std::to_string(window.x) + " x " +
                     std::to_string(window.y)};
  return Truth{camera, image->size, std::move(image->pixels)};
}

bool isOf(const Truth& truth, const Camera& camera, glm::ivec2 size) {
  const Camera& own = truth.camera;
  return sameProportions(truth.size, size) && camera.position == own.position &&
         camera.target == own.target && camera.up == own.up && camera.fov_degrees == own.fov_degrees;
}

}  // namespace loden::walk
