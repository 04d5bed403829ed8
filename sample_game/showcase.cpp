#include "sample_game/showcase.h"

#include <cmath>
#include <functional>

#include "material/model/directions.h"

namespace loden::walk {

using namespace runtime;

namespace {

constexpr float kPiF = static_cast<float>(kPi);

struct Point {
  glm::vec3 position;
  glm::vec2 uv;
};

// A grid over s and t from 0 to 1 whose normals are those of the surface itself.
Mesh gridMesh(const char* name, int columns, int rows, const std::function<Point(float, float)>& surface) {
  constexpr float kStep = 1e-3f;
  Mesh mesh;
  mesh.name = name;
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i) {
      const float s = float(i) / float(columns), t = float(j) / float(rows);
      const Point point = surface(s, t);
      const glm::vec3 along_s = surface(s + kStep, t).position - surface(s - kStep, t).position,
                      along_t = surface(s, t + kStep).position - surface(s, t - kStep).position;
      Vertex vertex;
      vertex.position = point.position;
      vertex.normal = glm::normalize(glm::cross(along_s, along_t));
      vertex.uv = point.uv;
      mesh.vertices.push_back(vertex);
    }
  const auto row = static_cast<uint32_t>(columns + 1);
  for (uint32_t j = 0; j < uint32_t(rows); ++j)
    for (uint32_t i = 0; i < uint32_t(columns); ++i) {
      const uint32_t a = j * row + i, d = a + row;
      mesh.indices.insert(mesh.indices.end(), {a, a + 1, d + 1, a, d + 1, d});
    }
  mesh.bounds = boundsOf(mesh);
  computeTangents(mesh);
  return mesh;
}

// Hangs from y = 0.95 in folds that open downwards.
Point cloth(float s, float t) {
  constexpr float kWidth = 0.86f, kHeight = 0.92f;
  const float drop = 1 - t, phase = 2 * kPiF * 3.5f * s + 0.8f * std::sin(4.3f * s + 1.1f * drop);
  const float fold = (0.012f + 0.05f * drop) * std::sin(phase) + 0.03f * drop * std::sin(2.1f * s + 0.6f);
  // Folds take up cloth: as long along s as the wave is.
  return {{(s - 0.5f) * kWidth, 0.03f + t * kHeight, fold}, {s * kWidth * 1.18f, t * kHeight}};
}

Point sphere(float s, float t) {
  constexpr float kRadius = 0.17f, kPole = 1e-3f;
  const float phi = 2 * kPiF * s, theta = kPiF * (kPole + (1 - 2 * kPole) * t);
  const glm::vec3 normal(std::sin(theta) * std::sin(phi), -std::cos(theta), std::sin(theta) * std::cos(phi));
  return {kRadius * normal, {kRadius * phi, kRadius * theta}};
}

Point plane(float s, float t) {
  constexpr float kWidth = 1.7f, kDepth = 1.25f;
  return {{(s - 0.5f) * kWidth, 0, (0.5f - t) * kDepth}, {s * kWidth, t * kDepth}};
}

}  // namespace

Scene showcaseScene(const std::filesystem::path& asset, const TileFacts& facts, double period) {
  Scene scene;
  scene.name = facts.name;
  scene.meshes = {gridMesh("cloth", 84, 16, &cloth), gridMesh("sphere", 64, 32, &sphere),
                  gridMesh("plane", 1, 1, &plane)};
  SceneMaterial material;
  material.name = facts.name;
  material.base_color = glm::vec4(facts.color, 1);
  material.metallic = 0;
  material.double_sided = true;
  FlatBtfBinding binding;
  binding.asset = assetIndex(scene, asset);
  binding.scale = glm::vec2(1 / period, 1 / (period * facts.aspect));
  material.flat_btf = binding;
  scene.materials.push_back(material);
  const auto place = [&](const char* name, int mesh, const glm::vec3& position) {
    Instance instance;
    instance.name = name;
    instance.mesh = mesh;
    instance.material = 0;
    instance.world_from_local[3] = glm::vec4(position, 1);
    scene.instances.push_back(instance);
  };
  place("cloth", 0, {0.22f, 0, -0.32f});
  place("sphere", 1, {-0.42f, 0.172f, 0.12f});
  place("plane", 2, {0, 0, 0});
  return scene;
}

}  // namespace loden::walk
