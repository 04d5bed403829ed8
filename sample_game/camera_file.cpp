#include "sample_game/camera_file.h"

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "material/base/issues.h"

namespace loden::walk {
namespace {

using Json = nlohmann::json;

glm::dvec3 readVector(const Json& object, const char* key) {
  const Json& value = object.at(key);
  if (!value.is_array() || value.size() != 3)
    throw std::runtime_error(std::string(key) + " must be three numbers");
  const glm::dvec3 v(value[0].get<double>(), value[1].get<double>(), value[2].get<double>());
  if (!std::isfinite(v.x + v.y + v.z)) throw std::runtime_error(std::string(key) + " must be finite");
  return v;
}

Camera readLens(const Json& object, const glm::dvec3& up) {
  Camera camera;
  camera.up = object.contains("up") ? readVector(object, "up") : up;
  camera.fov_degrees = object.value("fov_degrees", camera.fov_degrees);
  if (!(camera.fov_degrees > 0 && camera.fov_degrees < 175))
    throw std::runtime_error("fov_degrees must be 0 .. 175");
  return camera;
}

void checkView(const glm::dvec3& position, const glm::dvec3& target, const glm::dvec3& up) {
  if (!(glm::length(glm::cross(target - position, up)) > 1e-9 * glm::length(target - position)))
    throw std::runtime_error("position, target and up must span a plane");
}

// Runs `read` on the file's JSON; whatever goes wrong becomes an Issue that names the file.
template <class T, class Read>
Result<T> readJson(const std::filesystem::path& path, const Read& read) {
  std::ifstream in(path);
  std::error_code none;
  if (!in || std::filesystem::is_directory(path, none))
    return Issue{issue_id::kCannotOpen, Severity::kError, path.string(), "cannot be opened for reading"};
  try {
    return read(Json::parse(in));
  } catch (const std::exception& error) {
    return Issue{issue_id::kOption, Severity::kError, path.string(), error.what()};
  }
}

}  // namespace

Result<Camera> readCamera(const std::filesystem::path& path, const glm::dvec3& up) {
  return readJson<Camera>(path, [&](const Json& json) {
    Camera camera = readLens(json, up);
    camera.position = readVector(json, "position");
    camera.target = readVector(json, "target");
    checkView(camera.position, camera.target, camera.up);
    return camera;
  });
}

Result<runtime::CameraPath> readCameraPath(const std::filesystem::path& path, const glm::dvec3& up) {
  return readJson<runtime::CameraPath>(path, [&](const Json& json) {
    const Camera lens = readLens(json, up);
    std::vector<runtime::CameraPath::Key> keys;
    for (const Json& frame : json.at("keyframes")) {
      keys.push_back(
          {frame.at("t").get<double>(), readVector(frame, "position"), readVector(frame, "target")});
      checkView(keys.back().position, keys.back().target, lens.up);
      if (keys.size() > 1 && !(keys.back().t > keys[keys.size() - 2].t))
        throw std::runtime_error("keyframes: times must increase");
    }
    if (keys.empty()) throw std::runtime_error("keyframes: there are none");
    return runtime::CameraPath(std::move(keys), lens);
  });
}

}  // namespace loden::walk
