#include "runtime/scene/mesh_analytic.h"

#include "material/model/directions.h"

namespace loden::runtime {
namespace {

glm::ivec2 segmentsOf(SurfaceKind kind) {
  switch (kind) {
    case SurfaceKind::kCylinder:
      return {768, 1};
    case SurfaceKind::kSphere:
      return {768, 384};
    case SurfaceKind::kPlane:
      break;
  }
  return {1, 1};
}

Vertex vertexAt(const AnalyticSurface& surface, glm::dvec2 st) {
  const SurfaceFrame frame = surfaceFrame(surface, st);
  return {glm::vec3(frame.position), glm::vec3(frame.normal), glm::vec4(glm::vec3(frame.tangent), 1),
          glm::vec2(st * surface.tiles)};
}

}  // namespace

Mesh analyticMesh(const AnalyticSurface& surface) {
  const glm::ivec2 n = segmentsOf(surface.kind);
  Mesh mesh;
  mesh.name = "surface";
  for (int j = 0; j <= n.y; ++j)
    for (int i = 0; i <= n.x; ++i)
      mesh.vertices.push_back(vertexAt(surface, {double(i) / n.x, double(j) / n.y}));
  const uint32_t row = n.x + 1;
  for (int j = 0; j < n.y; ++j)
    for (int i = 0; i < n.x; ++i) {
      const uint32_t a = j * row + i, d = a + row;
      mesh.indices.insert(mesh.indices.end(), {a, a + 1, d + 1, a, d + 1, d});
    }
  mesh.bounds = boundsOf(mesh);
  return mesh;
}

Scene analyticScene(SurfaceKind kind, const std::filesystem::path& asset, const glm::vec3& to_light,
                    double aspect) {
  Scene scene;
  scene.name = asset.stem().string();
  scene.meshes.push_back(analyticMesh(analyticSurface(kind, aspect)));
  scene.assets.push_back({asset, {}, asset.string()});
  SceneMaterial material;
  material.name = scene.name;
  material.flat_btf = FlatBtfBinding{};
  scene.materials.push_back(material);
  scene.instances.push_back({"surface", 0, 0, glm::mat4(1)});
  Light sun;
  sun.kind = LightKind::kSun;
  sun.direction = -to_light;
  sun.intensity = glm::vec3(static_cast<float>(kPi));
  scene.lights.push_back(sun);
  return scene;
}

}  // namespace loden::runtime
