// The surfaces of material/model/analytic_surface.h as scenes, for `loden_walk --surface`.
#pragma once

#include <filesystem>

#include "material/model/analytic_surface.h"
#include "runtime/scene/scene.h"

namespace loden::runtime {

// A mesh of the surface whose uv are the tile coordinates x. It is fine enough that silhouettes and normals
// are exact to a fraction of a pixel.
Mesh analyticMesh(const AnalyticSurface& surface);

// A scene of the surface covered with one asset, and a sun of irradiance pi from `to_light` (unit, world),
// which is the scene that `loden trace` traces. z is up. `aspect` is the asset's Material::aspect.
Scene analyticScene(SurfaceKind kind, const std::filesystem::path& asset, const glm::vec3& to_light,
                    double aspect = 1);

}  // namespace loden::runtime
