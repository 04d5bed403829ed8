// Cameras and camera paths from JSON files.
#pragma once

#include <filesystem>

#include "material/base/result.h"
#include "material/model/analytic_surface.h"
#include "runtime/scene/camera.h"

namespace loden::walk {

// {"position":[x,y,z],"target":[x,y,z],"up":[x,y,z],"fov_degrees":f}; `up` and 40 degrees where a file has
// none.
Result<Camera> readCamera(const std::filesystem::path& path, const glm::dvec3& up);

// {"fov_degrees":f,"up":[x,y,z],"keyframes":[{"t":seconds,"position":[..],"target":[..]}, ...]}, times
// increasing.
Result<runtime::CameraPath> readCameraPath(const std::filesystem::path& path, const glm::dvec3& up);

}  // namespace loden::walk
