// Cameras that see all of something.
#pragma once

#include "material/model/analytic_surface.h"
#include "runtime/scene/scene.h"

namespace loden::walk {

// Around all instances of the scene, world.
runtime::Bounds boundsOfAll(const runtime::Scene& scene);

// Towards the box's middle from a direction (from there to the camera, unit), as close as leaves all corners
// of the box in a picture of that shape.
Camera framedFrom(const runtime::Bounds& box, const glm::dvec3& direction, double aspect);
// Before the box, a little above and to its right.
Camera framed(const runtime::Bounds& box, double aspect);

}  // namespace loden::walk
