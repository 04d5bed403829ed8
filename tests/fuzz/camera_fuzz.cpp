// Any bytes as a camera and as a camera path of loden_walk: no crash, and what is accepted gives finite
// views at all times.
#include <cmath>
#include <cstdint>

#include "sample_game/camera_file.h"
#include "tests/fuzz/fuzz_input.h"

namespace {

bool isFinite(const glm::dvec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

void checkCamera(const loden::Camera& camera) {
  using loden::fuzz::require;
  require(isFinite(camera.position) && isFinite(camera.target) && isFinite(camera.up));
  require(camera.fov_degrees > 0 && camera.fov_degrees < 175);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const loden::fuzz::InputFolder folder;
  const glm::dvec3 up(0, 1, 0);
  const auto file = folder.write("input.json", loden::fuzz::textOf(data, size));
  if (const auto camera = loden::walk::readCamera(file, up)) checkCamera(*camera);
  if (const auto path = loden::walk::readCameraPath(file, up)) {
    const double duration = path->duration();
    for (const double at : {-1.0, 0.0, duration / 3, duration, duration + 1}) checkCamera(path->at(at));
  }
  return 0;
}
