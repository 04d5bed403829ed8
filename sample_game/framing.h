// Cameras that see all of something.
#pragma once

#include "material/model/analytic_surface.h"
#include "runtime/scene/scene.h"

namespace loden::walk {

// Bounding box of all instances of the scene, in world space.
runtime::Bounds boundsOfAll(const runtime::Scene& scene);

// A camera that looks at the middle of the box. `direction` is the unit vector from there to the camera. The
// camera is as close as it can be with all corners of the box in a picture of that aspect.
Camera framedFrom(const runtime::Bounds& box, const glm::dvec3& direction, double aspect);
// A camera that sees all of the box from the front, a little from above and from the right.
Camera framed(const runtime::Bounds& box, double aspect);

}  // namespace loden::walk
