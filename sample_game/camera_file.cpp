#include "sample_game/camera_file.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>
#include <stdexcept>
#include <string>

#include "material/base/issues.h"
#include "material/system/asset_io.h"

namespace loden::walk {
namespace {

using Json = nlohmann::json;

// What is wrong with a file's content.
class BadContent : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

const Json& member(const Json& object, const char* key) {
  if (!object.is_object())
    throw BadContent("must be a JSON object with the member '" + std::string(key) + "'");
  const auto found = object.find(key);
  if (found == object.end()) throw BadContent("has no '" + std::string(key) + "'");
  return *found;
}

double readNumber(const Json& object, const char* key) {
  const Json& value = member(object, key);
  if (!value.is_number()) throw BadContent("'" + std::string(key) + "' must be a number");
  return value.get<double>();
}

glm::dvec3 readVector(const Json& object, const char* key) {
  const Json& value = member(object, key);
  const bool three = value.is_array() && value.size() == 3 &&
                     std::all_of(value.begin(), value.end(), [](const Json& v) { return v.is_number(); });
  if (!three) throw BadContent("'" + std::string(key) + "' must be three numbers");
  const glm::dvec3 v(value[0].get<double>(), value[1].get<double>(), value[2].get<double>());
  if (!std::isfinite(v.x + v.y + v.z)) throw BadContent("'" + std::string(key) + "' must be finite");
  return v;
}

Camera readLens(const Json& object, const glm::dvec3& up) {
  if (!object.is_object()) throw BadContent("must be a JSON object");
  Camera camera;
  camera.up = object.contains("up") ? readVector(object, "up") : up;
  if (object.contains("fov_degrees")) camera.fov_degrees = readNumber(object, "fov_degrees");
  if (!(camera.fov_degrees > 0 && camera.fov_degrees < 175))
    throw BadContent("'fov_degrees' must lie between 0 and 175");
  return camera;
}

void checkView(const glm::dvec3& position, const glm::dvec3& target, const glm::dvec3& up) {
  if (!(glm::length(glm::cross(target - position, up)) > 1e-9 * glm::length(target - position)))
    throw BadContent("'position', 'target' and 'up' must span a plane");
}

// Runs `read` on the file's JSON; what is wrong with it becomes an issue that names the file.
template <class T, class Read>
Result<T> readJson(const std::filesystem::path& path, const Read& read) {
  constexpr uint64_t kMaxBytes = uint64_t(1) << 26;
  const auto bad = [&](const std::string& text) {
    return Issue{issue_id::kCamera, Severity::kError, path.string(), text};
  };
  const auto source = openFileSource(path);
  if (!source) return source.issue();
  if ((*source)->size() > kMaxBytes) return bad("is larger than 64 MiB");
  std::string text((*source)->size(), '\0');
  if (Status status = (*source)->read(0, std::as_writable_bytes(std::span(text))); !status)
    return status.issue();
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) return bad("is no JSON");
  try {
    return read(json);
  } catch (const BadContent& error) {
    return bad(error.what());
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
    const Json& frames = member(json, "keyframes");
    if (!frames.is_array() || frames.empty())
      throw BadContent("'keyframes' must be an array that is not empty");
    for (const Json& frame : frames) {
      keys.push_back({readNumber(frame, "t"), readVector(frame, "position"), readVector(frame, "target")});
      checkView(keys.back().position, keys.back().target, lens.up);
      if (keys.size() > 1 && !(keys.back().t > keys[keys.size() - 2].t))
        throw BadContent("'keyframes': the times 't' must increase");
    }
    return runtime::CameraPath(std::move(keys), lens);
  });
}

}  // namespace loden::walk
