// Cameras and camera paths from JSON files.
#pragma once

#include <filesystem>

#include "material/base/result.h"
#include "material/model/analytic_surface.h"
#include "runtime/scene/camera.h"

namespace loden::walk {

// The camera of a file {"position":[x,y,z],"target":[x,y,z],"up":[x,y,z],"fov_degrees":f}. Where the file has
// no "up" it is `up`; where it has no angle, 40 degrees.
Result<Camera> readCamera(const std::filesystem::path& path, const glm::dvec3& up);

// The path of a file {"fov_degrees":f,"up":[x,y,z],"keyframes":[{"t":seconds,"position":[..],"target":[..]},
// ...]} whose times increase.
Result<runtime::CameraPath> readCameraPath(const std::filesystem::path& path, const glm::dvec3& up);

}  // namespace loden::walk
